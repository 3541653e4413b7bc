"""Track objects: groups of a window's dense tracks that no rigid scene explains."""

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import TrackFieldParams, TrackObjectParams
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def _run(params, inputs, rng):
    from moseg.tasks.track_objects import PairEvidence, couple_tracks, find_objects, mean_field, track_evidence

    tracks, rigidity = inputs["dense_tracks"], inputs["rigidity"]
    points, visible = tracks.array("points"), tracks.array("visible")
    evidence = PairEvidence(*(rigidity.array(name) for name in PairEvidence._fields))
    field = TrackFieldParams.of_recipe(params["field"])
    state = mean_field(track_evidence(evidence, field), couple_tracks(points, visible, field), field)
    found = find_objects(points, visible, state, evidence, TrackObjectParams.of_recipe(params["objects"]))
    # The reasons for the decision.
    reasons = ("strength", "test", "num_tracks", "num_observations")
    return Output(
        {"object": found.object, "is_moving": found.is_moving, "scores": found.score},
        {name: getattr(found, name).tolist() for name in reasons},
    )


def _params(config: PipelineConfig) -> dict:
    return {
        "field": config.track_field.model_dump(mode="json"),
        "objects": config.track_objects.model_dump(mode="json"),
    }


MEAN_FIELD = Task("track_objects", "mean-field", version=1, run=_run, params=_params)

STAGE = Stage(
    name="track_objects",
    about="objects of a window's dense tracks",
    inputs={
        "dense_tracks": "tracks of the window",
        "rigidity": "their deviation from a rigid scene",
    },
    arrays={
        "object": layout("uint16", "track", "candidate for a moving object, 0 = background"),
        "is_moving": layout("bool", "object", "whether the candidate has enough evidence to be proposed"),
        "scores": layout("float64", "object", "summed errors, in tolerances, times the mean rigidity test"),
    },
    tasks=(MEAN_FIELD,),
)
