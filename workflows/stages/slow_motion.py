"""Slow motion: distance of the pictures between which the motion of a stretch is seen."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import SaliencyParams, SlowMotionParams
from moseg.workflows.stages.flow import flow_on_working_grid
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

PLACE_PARAMS = frozenset({"num_pairs", "min_pairs", "stretch_length", "max_gap"})
"""Parameters that only choose the pairs, and the longest distance."""
LAYER_PARAMS = frozenset(
    {"working_side", "border_band", "centre_thinning", "tukey_constant"}
    | {name for name in SaliencyParams.model_fields if name.startswith(("ransac_", "affine_", "layer_"))}
)
"""Parameters of saliency that the fit of the background's layers reads."""


def _run(params, inputs, rng):
    from moseg.tasks.slow_motion import choose_gap

    saliency_params = SaliencyParams.of_recipe(params["saliency"])
    flows = (flow_on_working_grid(pair, saliency_params.working_side) for pair in inputs.all("flows"))
    read = SlowMotionParams.of_recipe(params["slow_motion"])
    return Output({}, choose_gap(flows, params["longest"], read, saliency_params)._asdict())


def _params(config: PipelineConfig, longest: int) -> dict:
    """Return the parameters of a stretch of a video that is long enough for pairs `longest` pictures apart."""
    return {
        "longest": longest,
        "slow_motion": config.slow_motion.model_dump(mode="json", exclude=PLACE_PARAMS),
        "saliency": config.saliency.model_dump(mode="json", include=LAYER_PARAMS),
    }


FLOW_PERCENTILES = Task("slow_motion", "flow-percentiles", version=1, run=_run, params=_params)

STAGE = Stage(
    name="slow_motion",
    about="distance of the pictures between which the motion of a stretch is seen",
    inputs={"flows": "flow of neighbouring frames at fixed places of the stretch"},
    arrays={},
    tasks=(FLOW_PERCENTILES,),
)
