"""The flow model of a section's frame pairs: parameters per object by least squares, and every object's residual.

The pairs of a section are stacked in one artifact: fitting a pair takes less time than storing it alone would.
"""

import numpy as np

from moseg.schemas.parameters import FlowModelParams
from moseg.tasks.motion_models import FLOW_MODELS, fit_from_moments, flow_energy, flow_moments, residuals_from_moments
from moseg.workflows.stages.task import Output, Task


def read_pairs(params, inputs, flow_model_params: FlowModelParams):
    """For each pair the flow, the inverse depth or None, and the object of the sequence, of all pixels to be read."""
    identity = inputs["linking"].cached("identity")[params["section"]]
    masks = inputs["proposals"].cached("masks")
    flows = inputs.all("flow")
    depths = inputs.all("depth") if "depth" in inputs else [None] * len(flows)
    for mask, flow, depth in zip(masks[: len(flows)], flows, depths, strict=True):
        vectors = flow.cached("flow")
        read = (slice(None, None, flow_model_params.step),) * 2
        if not np.isfinite(vectors[read]).all():
            # Given flow knows some pixels only, which may be just those that would be left out.
            read = (slice(None),) * 2
        rho = None if depth is None else np.ascontiguousarray(depth.array("inverse_depth")[read])
        yield np.ascontiguousarray(vectors[read]), rho, identity[mask[read]]


def _run_fit(params, inputs, rng):
    model = FLOW_MODELS[params["model"]]
    flow_model_params = FlowModelParams.of_recipe(params["flow_model"])
    num_objects = inputs["linking"].attributes["num_objects"]
    moments, theta, valid = [], [], []
    for flow, depth, owner in read_pairs(params, inputs, flow_model_params):
        moments.append(flow_moments(flow, depth, owner, num_objects, model, flow_model_params))
        fitted, usable = fit_from_moments(moments[-1], model, flow_model_params)
        theta.append(fitted)
        valid.append(usable)
    return Output({"theta": np.stack(theta), "valid": np.stack(valid), "moments": np.stack(moments)})


def _run_residual(params, inputs, rng):
    moments, theta, valid = (inputs["fits"].array(name) for name in ("moments", "theta", "valid"))
    residual = np.stack([residuals_from_moments(*pair) for pair in zip(moments, theta, valid, strict=True)])
    return Output({"residual": residual, "energy": np.stack([flow_energy(pair) for pair in moments])})


LEAST_SQUARES_FIT = Task("flow_model", "least-squares", version=2, run=_run_fit)
MSE_RESIDUAL = Task("flow_residual", "mean-squared-error", version=1, run=_run_residual)
