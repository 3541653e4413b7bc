"""Repetitions: frames of a stretch that show the picture before them, coded again."""

from itertools import pairwise

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import RepetitionParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

PLACE_PARAMS = frozenset({"stretch_length"})
"""Parameters that only choose the frames."""


def _run(params, inputs, rng):
    from moseg.tasks.repetitions import find_repetitions, mean_change

    read = RepetitionParams.of_recipe(params["repetitions"])
    images = (frame.cached("image") for frame in inputs.all("frames"))
    changes = [mean_change(*pair, read.step) for pair in pairwise(images)]
    # A change leads to the frame after it.
    found = [change + 1 for change in find_repetitions(changes, read)]
    return Output({}, {"repetitions": [row for row in found if params["first"] <= row < params["last"]]})


def _params(config: PipelineConfig, first: int, last: int) -> dict:
    """Return the parameters of a stretch that is the rows first..last of the frames that are read."""
    read = config.repetitions.model_dump(mode="json", exclude=PLACE_PARAMS)
    return {"first": first, "last": last, "repetitions": read}


SMALL_CHANGES = Task("repetitions", "small-changes", version=1, run=_run, params=_params)

STAGE = Stage(
    name="repetitions",
    about="frames of a stretch that repeat the one before them",
    inputs={"frames": "frames of the stretch that differ, and some on either side"},
    arrays={},
    tasks=(SMALL_CHANGES,),
)
