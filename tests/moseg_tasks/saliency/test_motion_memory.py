"""Memory of clear motion along the flow, without memory of a single false alarm."""

import numpy as np

from moseg.schemas.parameters import ForegroundParams, MotionMemoryParams
from moseg.tasks.saliency import accumulate, foreground_probability, motion_odds, remembered_logit

PARAMS, FOREGROUND = MotionMemoryParams(), ForegroundParams()
SHAPE = (4, 6)


def remember(saliency):
    """Return the logit that is remembered after frames of a saliency each, on a surface that rests in the image."""
    odds = [motion_odds(np.full(SHAPE, value, np.float32), PARAMS, FOREGROUND) for value in saliency]
    flows = [np.zeros((*SHAPE, 2), np.float32)] * len(odds)
    accumulated = accumulate(odds, flows, [PARAMS.memory] * len(odds))
    return remembered_logit(accumulated[-1].astype(np.float32))[0, 0]


def test_what_has_moved_stays_foreground_through_thirty_frames_of_rest():
    assert remember([0.9] * 12 + [0.02] * 30) > 0


def test_one_false_alarm_in_many_frames_is_not_remembered():
    assert remember([0.02] * 20 + [0.99] + [0.02] * 10) < 0


def test_the_odds_of_a_frame_are_bounded():
    assert motion_odds(np.ones(SHAPE, np.float32), PARAMS, FOREGROUND).max() <= PARAMS.max_odds * (1 + 1e-6)


def test_the_memory_only_adds_to_the_evidence_of_motion():
    def moves(remembered):
        saliency, reliability = np.full(SHAPE, 0.3, np.float32), np.ones(SHAPE, np.float32)
        nothing, memory = np.zeros(SHAPE, np.float32), np.full(SHAPE, remembered, np.float32)
        return foreground_probability(saliency, reliability, nothing, nothing, 1.0, FOREGROUND, memory)[0, 0]

    assert moves(-9) == moves(-6) < 0.5 < moves(2)
