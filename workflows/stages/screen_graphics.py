"""Screen graphics: where logos, clocks and the like were drawn into a video's frames."""

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ScreenGraphicsParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

UNREAD_PARAMS = frozenset({"fill", "num_frames"})
"""Parameters that choose the frames, and what becomes of the graphics."""


def _run(params, inputs, rng):
    from moseg.tasks.screen_graphics import find_graphics

    bars = BlackBars(**inputs["bars"].attributes["bars"])
    frames, following = (inputs.all(role) for role in ("frames", "following"))
    picture = bars.picture(frames[0].shape("image")[:2])
    images, later = ([frame.cached("image")[picture] for frame in each] for each in (frames, following))
    found = find_graphics(images, later, ScreenGraphicsParams.of_recipe(params["screen_graphics"]))
    return Output({}, {"graphics": found.moved(bars.left, bars.top).as_json()})


def _params(config: PipelineConfig) -> dict:
    return {"screen_graphics": config.screen_graphics.model_dump(mode="json", exclude=UNREAD_PARAMS)}


STILL_EDGES = Task("screen_graphics", "still-edges", version=2, run=_run, params=_params)

STAGE = Stage(
    name="screen_graphics",
    about="graphics that were drawn into a video's frames",
    inputs={
        "bars": "the black bars, inside which is searched",
        "frames": "some frames, spread over the video",
        "following": "the frame after each of these",
    },
    arrays={},
    tasks=(STILL_EDGES,),
)
