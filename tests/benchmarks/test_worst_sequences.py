"""The figure of clips with many errors: colours of matched motions, and rings around wrong trajectories."""

import importlib
import sys
from pathlib import Path

import numpy as np
import pytest

TRAJECTORIES = Path(__file__).resolve().parents[2] / "benchmarks" / "trajectories"
TRUTH = np.array([1, 1, 1, 2, 2, 2, 0])


@pytest.fixture(scope="module")
def worst():
    sys.path.insert(0, str(TRAJECTORIES))
    yield importlib.import_module("worst_sequences")
    sys.path.remove(str(TRAJECTORIES))


def _panels(worst, before, after):
    """Return the three panels of a clip of seven trajectories, without their titles."""
    x, y = np.meshgrid(50.0 * np.arange(4), 30.0 * np.arange(len(TRUTH)))
    points = np.stack([x, y], axis=-1)
    labels = TRUTH, np.array(before), np.array(after)
    outcome = worst.Outcome("clip", points, np.ones(points.shape[:2], bool), labels, (0.0, 0.0))
    return np.split(worst.draw_outcome(outcome)[worst.MARGIN :], 3, axis=1)


def _num_pixels(panel, colour):
    return np.count_nonzero((panel == np.array(colour, np.uint8)).all(axis=2))


def _num_dark(panel):
    return np.count_nonzero(panel.max(axis=2) < 60)


def test_groups_have_the_colours_of_their_motions_and_wrong_trajectories_have_rings(worst):
    truth, before, after = _panels(worst, [5, 5, 5, 3, 3, 3, 9], [3, 3, 5, 5, 5, 5, 5])
    # Only the trajectory without a label is in a group without a motion in one and in the second motion in the other.
    np.testing.assert_array_equal(before, truth)
    assert _num_dark(truth) == 0 < _num_dark(after)
    assert _num_pixels(truth, worst.UNMATCHED) > 0 == _num_pixels(after, worst.UNMATCHED)
    assert _num_pixels(truth, worst.COLOURS[1]) < _num_pixels(after, worst.COLOURS[1])


def test_a_group_without_a_motion_is_grey(worst):
    truth, before, _ = _panels(worst, [0, 0, 0, 1, 1, 2, 1], TRUTH)
    assert _num_pixels(before, worst.UNMATCHED) > 0
    assert _num_dark(before) > 0
    assert _num_pixels(before, worst.COLOURS[0]) == _num_pixels(truth, worst.COLOURS[0])
