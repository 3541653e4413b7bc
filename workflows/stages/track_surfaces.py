"""Track surfaces: surfaces of a window's dense tracks that stand above the ground, moving or not."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import RigidityParams, TrackSurfaceParams
from moseg.workflows.stages.picture import bars_of, bars_params, tracks_in_picture
from moseg.workflows.stages.rigidity import cameras_of, grounds_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task

READ_RIGIDITY = frozenset({"noise", "noise_share", "contact_parallax"})
"""Parameters of rigidity that it reads: the noise of displacements, and what exceeds the ground's parallax."""
MASK_PARAMS = frozenset({"mask_radius"})
"""Parameters of the masks of surfaces."""
COUNT_PARAMS = frozenset({"max_candidates", "halved_after"})
"""Parameters that say how many are proposed."""


def _run(params, inputs, rng):
    from moseg.tasks.track_objects import find_surfaces

    rigidity, shape = inputs["rigidity"], tuple(params["shape"])
    surface = find_surfaces(
        *tracks_in_picture(inputs, bars_of(params)),
        rigidity.array("pairs"),
        cameras_of(rigidity, shape),
        grounds_of(rigidity),
        shape,
        TrackSurfaceParams.of_recipe(params["surfaces"]),
        RigidityParams.of_recipe(params["rigidity"]),
    )
    return Output({"surface": surface}, {"num_tracks": np.bincount(surface)[1:].tolist()})


def _params(config: PipelineConfig, shape: tuple[int, int], bars: BlackBars | None = None) -> dict:
    return {
        "shape": list(shape if bars is None else bars.picture_shape(shape)),
        **bars_params(bars),
        "surfaces": config.track_surfaces.model_dump(mode="json", exclude=MASK_PARAMS | COUNT_PARAMS),
        "rigidity": config.rigidity.model_dump(mode="json", include=READ_RIGIDITY),
    }


STANDING = Task("track_surfaces", "standing", version=1, run=_run, params=_params)

STAGE = Stage(
    name="track_surfaces",
    about="surfaces of a window's dense tracks that stand above the ground",
    inputs={"dense_tracks": "tracks of the window", "rigidity": "their deviation from a rigid scene"},
    arrays={"surface": layout("uint16", "track", "surface by falling number of tracks, 0 = none")},
    tasks=(STANDING,),
)
