"""Moving tracks: log-odds of motion of a window's dense tracks, and the candidates for objects that they form."""

import numpy as np

from moseg.schemas.arrays import layout
from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import CandidateParams, TrackFieldParams
from moseg.workflows.stages.inputs import Inputs
from moseg.workflows.stages.stage import Stage
from moseg.workflows.stages.task import Output, Task


def tracks_of(inputs: Inputs) -> tuple[np.ndarray, np.ndarray]:
    """Return the points float32 (track, frame, xy), px, of a window's tracks, and bool (track, frame) where visible."""
    return inputs["dense_tracks"].array("points"), inputs["dense_tracks"].array("visible")


def evidence_of(inputs: Inputs):
    """Return the evidence of a window's tracks in all frame pairs, a `PairEvidence`."""
    from moseg.tasks.track_objects import PairEvidence

    return PairEvidence(*(inputs["rigidity"].array(name) for name in PairEvidence._fields))


def _run(params, inputs, rng):
    from moseg.tasks.track_objects import couple_tracks, find_candidates, mean_field, track_evidence

    tracks, evidence = tracks_of(inputs), evidence_of(inputs)
    field = TrackFieldParams.of_recipe(params["field"])
    state = mean_field(track_evidence(evidence, field), couple_tracks(*tracks, field), field)
    candidate = find_candidates(*tracks, state, evidence, CandidateParams.of_recipe(params["candidates"]))
    return Output({"state": state.astype(np.float32), "candidate": candidate})


def _params(config: PipelineConfig) -> dict:
    return {
        "field": config.track_field.model_dump(mode="json"),
        "candidates": config.track_candidates.model_dump(mode="json"),
    }


MEAN_FIELD = Task("moving_tracks", "mean-field", version=2, run=_run, params=_params)

STAGE = Stage(
    name="moving_tracks",
    about="candidates for moving objects among a window's dense tracks",
    inputs={"dense_tracks": "tracks of the window", "rigidity": "their deviation from a rigid scene"},
    arrays={
        "state": layout("float32", "track", "log-odds of motion"),
        "candidate": layout("uint16", "track", "candidate for a moving object, 0 = none"),
    },
    tasks=(MEAN_FIELD,),
)
