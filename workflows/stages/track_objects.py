"""Track objects: groups of a window's dense tracks that no rigid scene explains."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.black_bars import BlackBars
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import CandidateParams, TrackObjectParams
from moseg.workflows.stages.moving_tracks import evidence_of
from moseg.workflows.stages.picture import bars_of, bars_params, tracks_in_picture
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task
from moseg.workflows.stages.track_groups import samples_of


def _run(params, inputs, rng):
    from moseg.tasks.track_objects import judge_objects, regroup_candidates, without_own_vehicle

    tracks, candidate = tracks_in_picture(inputs, bars_of(params)), inputs["moving_tracks"].array("candidate")
    object_params = TrackObjectParams.of_recipe(params["objects"])
    join = CandidateParams.of_recipe(params["candidates"])
    regrouped = regroup_candidates(*tracks, candidate, samples_of(inputs), join, object_params.regroup)
    groups = without_own_vehicle(regrouped, *tracks, tuple(params["shape"]), object_params.own_vehicle)
    is_vehicle = (regrouped.group >= 0) & (groups.group < 0)
    surface = np.where(is_vehicle, 0, inputs["track_surfaces"].array("surface"))
    found = judge_objects(groups, candidate, surface, *tracks, evidence_of(inputs), object_params)
    # The reasons for the decision.
    reasons = ("strength", "test", "num_tracks", "num_observations", "best_part", "on_surface")
    return Output(
        {"object": found.object, "is_moving": found.is_moving, "scores": found.score},
        {
            **{name: getattr(found, name).tolist() for name in reasons},
            "own_vehicle": int(np.count_nonzero(is_vehicle)),
        },
    )


def _params(config: PipelineConfig, shape: tuple[int, int], bars: BlackBars | None = None) -> dict:
    return {
        "shape": list(shape if bars is None else bars.picture_shape(shape)),
        **bars_params(bars),
        "candidates": config.track_candidates.model_dump(mode="json"),
        "objects": config.track_objects.model_dump(mode="json"),
    }


ABSOLUTE_EVIDENCE = Task("track_objects", "absolute-evidence", version=8, run=_run, params=_params)

STAGE = Stage(
    name="track_objects",
    about="objects of a window's dense tracks",
    inputs={
        "dense_tracks": "tracks of the window",
        "rigidity": "their deviation from a rigid scene",
        "moving_tracks": "candidates for moving objects",
        "track_groups": "motion groups of samples of the tracks",
        "track_surfaces": "surfaces of the tracks that stand above the ground",
    },
    arrays={
        "object": layout("uint16", "track", "object, moving or not, 0 = background"),
        "is_moving": layout("bool", "object", "whether the object has enough evidence to be proposed"),
        "scores": layout("float64", "object", "summed errors, in tolerances, times the mean rigidity test, per frame"),
    },
    tasks=(ABSOLUTE_EVIDENCE,),
)
