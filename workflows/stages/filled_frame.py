"""Filled frame: a frame whose black bars continue the border of the picture, in place of the frame for the analysis."""

from moseg.schemas.arrays import LEAF_LAYOUTS
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.black_bars import fill_bars

    return Output({"image": fill_bars(inputs["frame"].array("image"), BlackBars(**params["bars"]))})


def _params(config: PipelineConfig, bars: BlackBars) -> dict:
    return {"bars": bars._asdict()}


BORDER_REPLICATED = Task(
    "filled_frame", "border-replicated", version=1, run=_run, params=_params, is_cheap=True, is_cue=True
)

STAGE = Stage(
    name="filled_frame",
    about="a frame whose black bars continue the border of the picture",
    inputs={"frame": "the frame"},
    arrays=LEAF_LAYOUTS["frame"],
    tasks=(BORDER_REPLICATED,),
)
