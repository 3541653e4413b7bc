"""Object points: points of a window's moving objects where their tracks end, and corners on both sides of outlines."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ObjectPointParams
from moseg.workflows.stages.moving_tracks import tracks_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def moving_objects(inputs) -> np.ndarray:
    """Return the moving object of each track of a window, uint16 (track,); 0 = none."""
    found = inputs["track_objects"]
    objects, moves = found.array("object"), np.concatenate([[False], found.array("is_moving")])
    return np.where(moves[objects], objects, 0).astype(np.uint16)


def _run(params, inputs, rng):
    from moseg.tasks.object_points import follow_objects

    frames = inputs.all("frames")
    found = follow_objects(
        lambda frame: frames[frame].cached("image"),
        *tracks_of(inputs),
        moving_objects(inputs),
        ObjectPointParams.of_recipe(params),
    )
    return Output(found._asdict())


def _params(config: PipelineConfig) -> dict:
    return config.object_points.model_dump(mode="json")


OBJECT_MOTION = Task("object_points", "object-motion", version=1, run=_run, params=_params)

STAGE = Stage(
    name="object_points",
    about="points of a window's moving objects beside its tracks",
    inputs={
        "frames": "frames of the window",
        "dense_tracks": "tracks of the window",
        "track_objects": "objects of these tracks",
    },
    arrays={
        "points": layout("float32", "point frame xy", "px; 0 where not visible"),
        "visible": layout("bool", "point frame"),
        "object": layout("uint16", "point", "moving object, 0 = background"),
    },
    tasks=(OBJECT_MOTION,),
)
