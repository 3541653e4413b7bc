"""Track objects: groups of a window's dense tracks that no rigid scene explains."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import CandidateParams, TrackObjectParams
from moseg.workflows.stages.moving_tracks import evidence_of, tracks_of
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task
from moseg.workflows.stages.track_groups import samples_of


def _run(params, inputs, rng):
    from moseg.tasks.track_objects import judge_objects, regroup_candidates

    tracks, candidate = tracks_of(inputs), inputs["moving_tracks"].array("candidate")
    object_params = TrackObjectParams.of_recipe(params["objects"])
    join = CandidateParams.of_recipe(params["candidates"])
    regrouped = regroup_candidates(*tracks, candidate, samples_of(inputs), join, object_params.regroup)
    surface = inputs["track_surfaces"].array("surface")
    found = judge_objects(regrouped, candidate, surface, *tracks, evidence_of(inputs), object_params)
    # The reasons for the decision.
    reasons = ("strength", "test", "num_tracks", "num_observations", "best_part", "on_surface")
    return Output(
        {"object": found.object, "is_moving": found.is_moving, "scores": found.score},
        {name: getattr(found, name).tolist() for name in reasons},
    )


def _params(config: PipelineConfig) -> dict:
    return {
        "candidates": config.track_candidates.model_dump(mode="json"),
        "objects": config.track_objects.model_dump(mode="json"),
    }


ABSOLUTE_EVIDENCE = Task("track_objects", "absolute-evidence", version=7, run=_run, params=_params)

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
