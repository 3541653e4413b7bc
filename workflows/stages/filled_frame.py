"""Filled frame: a frame without black bars and graphics, in place of the frame for the analysis."""

from moseg.schemas.arrays import LEAF_LAYOUTS
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.workflows.stages.picture import bars_of, bars_params
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.black_bars import fill_bars

    return Output({"image": fill_bars(inputs["frame"].array("image"), bars_of(params))})


def _run_nearest(params, inputs, rng):
    from moseg.tasks.screen_graphics import fill_graphics

    graphics = ScreenGraphics(**params["graphics"])
    return Output({"image": fill_graphics(inputs["frame"].array("image"), graphics, bars_of(params))})


def _params(config: PipelineConfig, bars: BlackBars) -> dict:
    return bars_params(bars)


def _nearest_params(config: PipelineConfig, graphics: ScreenGraphics, bars: BlackBars | None = None) -> dict:
    return {"graphics": graphics.as_json()} | bars_params(bars)


BORDER_REPLICATED = Task(
    "filled_frame", "border-replicated", version=1, run=_run, params=_params, is_cheap=True, is_cue=True
)
NEAREST_SCENE = Task(
    "filled_frame", "nearest-scene", version=1, run=_run_nearest, params=_nearest_params, is_cheap=True, is_cue=True
)

STAGE = Stage(
    name="filled_frame",
    about="a frame whose black bars and graphics have the colours of the scene beside them",
    inputs={"frame": "the frame"},
    arrays=LEAF_LAYOUTS["frame"],
    tasks=(BORDER_REPLICATED, NEAREST_SCENE),
)
