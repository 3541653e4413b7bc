"""Kernel: affinity of a clip's trajectories by the hypotheses of one point model that they prefer."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import KernelParams
from moseg.workflows.stages.hypotheses import codes_name, points_of, read_hypotheses
from moseg.workflows.stages.model_codes import model_params, point_model_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.trajectories import HypothesisResiduals, choose_landmarks, trajectory_kernels

    points, visible = points_of(inputs)
    kernel_params = KernelParams.of_recipe(params["kernel"])
    tracks = choose_landmarks(points, visible, kernel_params.max_tracks)
    hypotheses = read_hypotheses(inputs["hypotheses"])
    residuals = HypothesisResiduals(hypotheses, points[tracks], visible[tracks], point_model_of(params))
    codes = residuals.all_codes()
    if codes is not None:
        # The clustering of the clip reads them too.
        inputs["hypotheses"].keep(codes_name(inputs["trajectories"], len(tracks)), codes)
    return Output({"kernel": trajectory_kernels(residuals, params["num_draws"], kernel_params)})


def _params(config: PipelineConfig, model: str) -> dict:
    kernel = config.kernel.model_dump(mode="json")
    return {**model_params("point", model), "num_draws": config.hypotheses.num_draws, "kernel": kernel}


ORDERED_RESIDUALS = Task("kernel", "ordered-residuals", version=2, run=_run, params=_params, is_brief=True)

STAGE = Stage(
    name="kernel",
    about="affinity of a clip's trajectories, or of landmarks among many, under one point model",
    inputs={"hypotheses": "of the model", "trajectories": "points of the clip"},
    arrays={"kernel": layout("float32", "draw landmark landmark")},
    tasks=(ORDERED_RESIDUALS,),
)
