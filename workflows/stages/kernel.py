"""Kernel: affinity of a clip's trajectories by the hypotheses of one point model that they prefer."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import KernelParams
from moseg.workflows.stages.hypotheses import points_of, read_hypotheses
from moseg.workflows.stages.model_codes import model_params, point_model_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.trajectories import HypothesisResiduals, trajectory_kernels

    residuals = HypothesisResiduals(read_hypotheses(inputs["hypotheses"]), *points_of(inputs), point_model_of(params))
    kernel_params = KernelParams.of_recipe(params["kernel"])
    return Output({"kernel": trajectory_kernels(residuals, params["num_draws"], kernel_params)})


def _params(config: PipelineConfig, model: str) -> dict:
    kernel = config.kernel.model_dump(mode="json")
    return {**model_params("point", model), "num_draws": config.hypotheses.num_draws, "kernel": kernel}


ORDERED_RESIDUALS = Task("kernel", "ordered-residuals", version=2, run=_run, params=_params)

STAGE = Stage(
    name="kernel",
    about="affinity of a clip's trajectories under one point model",
    inputs={"hypotheses": "of the model", "trajectories": "points of the clip"},
    arrays={"kernel": layout("float32", "draw track track")},
    tasks=(ORDERED_RESIDUALS,),
)
