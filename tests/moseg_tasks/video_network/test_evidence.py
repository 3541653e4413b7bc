import numpy as np
import pytest

from moseg.schemas.parameters import VideoNetworkParams
from moseg.tasks.video_network import (
    IGNORED,
    MOVING,
    STATIC,
    Outcome,
    measure_outcome,
    network_weight,
    refine_foreground,
)

PARAMS = VideoNetworkParams()


def test_the_centre_is_midway_to_the_logit_over_which_as_much_is_found_as_is_labelled():
    logits = np.linspace(-3, 3, 101, dtype=np.float32).reshape(1, 1, 101)
    labels = np.where(logits > 2, MOVING, STATIC).astype(np.uint8)
    objects = labels == MOVING
    centre, spread, growth = measure_outcome(logits, objects, labels)
    assert centre == pytest.approx(1.0, abs=0.05)
    assert spread == pytest.approx(logits.std(), rel=1e-4)
    assert growth == (logits > centre).sum() / objects.sum()


def test_pixels_without_a_label_do_not_move_the_centre():
    logits = np.linspace(-3, 3, 101, dtype=np.float32).reshape(1, 1, 101)
    labels = np.where(logits > 2, MOVING, STATIC).astype(np.uint8)
    doubtful = np.concatenate([labels, np.full_like(labels, IGNORED)])
    outcome = measure_outcome(np.concatenate([logits, logits + 9]), np.zeros_like(doubtful, bool), doubtful)
    assert outcome.centre == measure_outcome(logits, labels == MOVING, labels).centre


def test_the_outcome_of_a_constant_logit_and_of_no_object_is_finite():
    shape = (1, 3, 4)
    for labels in (np.full(shape, IGNORED, np.uint8), np.full(shape, STATIC, np.uint8)):
        outcome = measure_outcome(np.ones(shape, np.float32), np.zeros(shape, bool), labels)
        assert np.isfinite(outcome).all() and outcome.spread > 0


def test_the_weight_is_whole_up_to_the_tolerated_growth_and_shrinks_beyond():
    weights = [network_weight(Outcome(0, 1, growth * PARAMS.max_growth), PARAMS) for growth in (0.1, 1, 2, 4)]
    assert weights[0] == weights[1] == PARAMS.weight
    assert weights[2] == pytest.approx(PARAMS.weight / 4) and weights[3] == pytest.approx(PARAMS.weight / 16)


def test_a_logit_at_the_centre_changes_nothing_and_others_are_limited():
    foreground, outcome = np.full((1, 4), 0.4, np.float32), Outcome(2.0, 2.0, 1.0)
    logits = np.float32([[1, 3, 1e3, -1e3]])
    refined = refine_foreground(foreground, logits, outcome, PARAMS.model_copy(update={"caution": 0.5}))
    added = np.log(refined / (1 - refined)) - np.log(0.4 / 0.6)
    expected = PARAMS.weight * np.array([0, 1, PARAMS.limit, -PARAMS.limit])
    np.testing.assert_allclose(added[0], expected, atol=1e-4)
    assert refined.dtype == np.float32


def test_a_network_that_spreads_far_hardly_changes_the_foreground():
    foreground, logits = np.full((2, 2), 0.4, np.float32), np.full((2, 2), 3.0, np.float32)
    refined = refine_foreground(foreground, logits, Outcome(0, 1, 20.0), PARAMS)
    np.testing.assert_allclose(refined, foreground, atol=0.01)
