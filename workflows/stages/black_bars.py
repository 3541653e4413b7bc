"""Black bars: their widths at the sides of a video's frames."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import BlackBarParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

UNREAD_PARAMS = frozenset({"fill", "num_frames"})
"""Parameters that choose the frames, and what becomes of the bars."""


def _run(params, inputs, rng):
    from moseg.tasks.black_bars import find_bars

    images = (frame.cached("image") for frame in inputs.all("frames"))
    return Output({}, {"bars": find_bars(images, BlackBarParams.of_recipe(params["black_bars"]))._asdict()})


def _params(config: PipelineConfig) -> dict:
    return {"black_bars": config.black_bars.model_dump(mode="json", exclude=UNREAD_PARAMS)}


DARK_LINES = Task("black_bars", "dark-lines", version=1, run=_run, params=_params)

STAGE = Stage(
    name="black_bars",
    about="widths of the black bars at the sides of a video's frames",
    inputs={"frames": "some frames, spread over the video"},
    arrays={},
    tasks=(DARK_LINES,),
)
