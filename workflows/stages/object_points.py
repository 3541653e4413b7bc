"""Object points: points of a window's moving objects where their tracks end, and corners on both sides of outlines."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ObjectPointParams
from moseg.workflows.stages.picture import bars_of, bars_params, tracks_in_picture
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def moving_objects(inputs) -> np.ndarray:
    """Return the moving object of each track of a window, uint16 (track,); 0 = none."""
    found = inputs["track_objects"]
    objects, moves = found.array("object"), np.concatenate([[False], found.array("is_moving")])
    return np.where(moves[objects], objects, 0).astype(np.uint16)


def _run(params, inputs, rng):
    from moseg.tasks.object_points import follow_objects

    frames, bars = inputs.all("frames"), bars_of(params)
    picture = bars.picture(frames[0].shape("image")[:2])
    found = follow_objects(
        lambda frame: frames[frame].cached("image")[picture],
        *tracks_in_picture(inputs, bars),
        moving_objects(inputs),
        ObjectPointParams.of_recipe({name: value for name, value in params.items() if name != "bars"}),
    )
    found.points[found.visible] += np.float32(bars.corner)
    return Output(found._asdict())


def _params(config: PipelineConfig, bars: BlackBars | None = None) -> dict:
    return config.object_points.model_dump(mode="json") | bars_params(bars)


OBJECT_MOTION = Task("object_points", "object-motion", version=2, run=_run, params=_params)

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
