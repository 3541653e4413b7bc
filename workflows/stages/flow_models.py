"""The flow model of a frame pair: parameters per object by least squares, and every object's residual under them."""

from moseg_tasks.motion_models import FLOW_MODELS, fit_from_moments, flow_moments, residuals_from_moments
from schemas.parameters import FlowModelParams
from workflows.stages.task import Output, Task


def _run_fit(params, inputs, rng):
    model = FLOW_MODELS[params["model"]]
    identity = inputs["linking"].cached("identity")[params["section"]]
    masks = identity[inputs["proposals"].rows("masks", params["offset"], params["offset"] + 1)[0]]
    flow_model_params = FlowModelParams(**params["flow_model"])
    moments = flow_moments(
        inputs["flow"].array("flow"),
        inputs["depth"].array("inverse_depth") if "depth" in inputs else None,
        masks,
        inputs["linking"].attributes["num_objects"],
        model,
        flow_model_params,
    )
    theta, valid = fit_from_moments(moments, model, flow_model_params)
    return Output({"theta": theta, "valid": valid, "moments": moments})


def _run_residual(params, inputs, rng):
    moments, theta, valid = (inputs["fits"].array(name) for name in ("moments", "theta", "valid"))
    return Output({"residual": residuals_from_moments(moments, theta, valid)})


LEAST_SQUARES_FIT = Task("flow_model", "least-squares", version=1, run=_run_fit)
MSE_RESIDUAL = Task("flow_residual", "mean-squared-error", version=1, run=_run_residual)
