"""Background: model of the background's flow, chosen for a run of frames."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import SaliencyParams
from moseg.workflows.stages.flow import flow_on_working_grid
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

PAIRS_PARAMS = frozenset({"selection_length", "selection_step"})
"""Parameters that only choose the flows that the selection reads."""
SELECTION_PARAMS = PAIRS_PARAMS | {
    *("background", "gric_noise", "gric_step", "focals", "focal_residual", "focal_slack"),
    *("ground_agreement", "ground_hint", "ground_tilt"),
}
"""Parameters of saliency that only the selection reads."""
RESIDUAL_PARAMS = frozenset(
    {"ground_relief", "support_slope", "support_noise", "residual_blur", "floor", "floor_medians", "floor_motion"}
    | {"rest_motion", "rest_gradient", "rest_share"}
    | {"otsu_percentile", "outline_share", "outline_reach", "gate_blur", "gate_error", "strict_gate_error"}
)
"""Parameters of saliency that only the saliency of a frame reads."""


def _run(params, inputs, rng):
    from moseg.tasks.saliency import choose_background

    saliency_params = SaliencyParams.of_recipe(params)
    reduced = [flow_on_working_grid(pair, saliency_params.working_side) for pair in inputs.all("flows")]
    return Output({}, choose_background(reduced, saliency_params)._asdict())


def _params(config: PipelineConfig) -> dict:
    return config.saliency.model_dump(mode="json", exclude=RESIDUAL_PARAMS | PAIRS_PARAMS)


MODEL_SELECTION = Task("background", "model-selection", version=4, run=_run, params=_params)

STAGE = Stage(
    name="background",
    about="the background's model of flow",
    inputs={"flows": "flow of frame pairs at fixed places"},
    arrays={},
    tasks=(MODEL_SELECTION,),
)
