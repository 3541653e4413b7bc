"""Scene cuts: frames of a stretch that begin another scene."""

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import SceneCutParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

UNREAD_PARAMS = frozenset({"stretch_length", "apart"})
"""Parameters that choose the frames, and what becomes of the cuts."""


def _run(params, inputs, rng):
    from moseg.tasks.scene_cuts import find_cuts

    images = (frame.cached("image") for frame in inputs.all("frames"))
    cuts = find_cuts(images, SceneCutParams.of_recipe(params["scene_cuts"]))
    return Output({}, {"cuts": [row for row in cuts if params["first"] <= row < params["last"]]})


def _params(config: PipelineConfig, first: int, last: int) -> dict:
    """Return the parameters of a stretch that is the rows first..last of the frames that are read."""
    read = config.scene_cuts.model_dump(mode="json", exclude=UNREAD_PARAMS)
    return {"first": first, "last": last, "scene_cuts": read}


INCONSISTENT_CHANGES = Task("scene_cuts", "inconsistent-changes", version=3, run=_run, params=_params)

STAGE = Stage(
    name="scene_cuts",
    about="frames of a stretch that begin another scene",
    inputs={"frames": "frames of the stretch, and some on either side"},
    arrays={},
    tasks=(INCONSISTENT_CHANGES,),
)
