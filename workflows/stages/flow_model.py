"""Flow model: its parameters per object and frame pair of a section, by least squares (section 3.3).

The pairs of a section are stacked in one artifact: fitting a pair takes less time than storing it alone would.
"""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import FlowModelParams
from moseg.workflows.stages.flow import read_flow
from moseg.workflows.stages.model_codes import flow_model_of, model_params
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def read_pairs(params, inputs, fit_params: FlowModelParams):
    """Yield, for each pair, the flow, the inverse depth or None, and the object of the sequence, of all pixels read."""
    identity = inputs["linking"].cached("identity")[params["section"]]
    masks = inputs["proposals"].cached("masks")
    flows = inputs.all("flow")
    depths = inputs.all("depth") if "depth" in inputs else [None] * len(flows)
    for mask, flow, depth in zip(masks[: len(flows)], flows, depths, strict=True):
        vectors = read_flow(flow)
        read = (slice(None, None, fit_params.step),) * 2
        if not np.isfinite(vectors[read]).all():
            # Given flow may cover few pixels, and subsampling could leave out exactly those.
            read = (slice(None),) * 2
        rho = None if depth is None else np.ascontiguousarray(depth.array("inverse_depth")[read])
        yield np.ascontiguousarray(vectors[read]), rho, identity[mask[read]]


def _run(params, inputs, rng):
    from moseg.tasks.motion_models import fit_from_moments, flow_moments

    model = flow_model_of(params)
    fit_params = FlowModelParams.of_recipe(params["flow_model"])
    num_objects = inputs["linking"].attributes["num_objects"]
    moments, theta, valid = [], [], []
    for flow, depth, owner in read_pairs(params, inputs, fit_params):
        moments.append(flow_moments(flow, depth, owner, num_objects, model, fit_params))
        fitted, usable = fit_from_moments(moments[-1], model, fit_params)
        theta.append(fitted)
        valid.append(usable)
    return Output({"theta": np.stack(theta), "valid": np.stack(valid), "moments": np.stack(moments)})


def _params(config: PipelineConfig, section: int, model: str) -> dict:
    return {"section": section, **model_params("flow", model), "flow_model": config.flow_model.model_dump(mode="json")}


LEAST_SQUARES_FIT = Task("flow_model", "least-squares", version=2, run=_run, params=_params)

STAGE = Stage(
    name="flow_model",
    about="flow models of a section's frame pairs",
    inputs={
        "flow": "flow of every pair",
        "depth": "inverse depth of the first frame of every pair, for models that read it",
        "proposals": "objects of the section",
        "linking": "identities of its objects",
    },
    arrays={
        "theta": layout("float64", "section_pair object parameter"),
        "valid": layout("bool", "section_pair object"),
        "moments": layout("float64", "section_pair object moment"),
    },
    tasks=(LEAST_SQUARES_FIT,),
)
