"""Scores of groups of tracks."""

import numpy as np
import pytest

from moseg.tasks.track_objects.score import PAIRS_PER_FRAME, score_groups

VISIBLE = np.ones((4, 5), bool)
ERRORS = np.array([[1.0, 2.0, 9.0, 50.0], [3.0, np.nan, 9.0, 50.0]], np.float16)
TESTS = np.array([[1.0, 0.5, -1.0, 3.0], [2.0, np.nan, 0.0, 3.0]], np.float16)


def test_a_score_is_the_summed_error_times_the_mean_test_per_frame():
    found = score_groups(np.array([0, 0, 1, -1]), 2, VISIBLE, ERRORS, TESTS, max_error=12.0)
    np.testing.assert_allclose(found.strength, [6, 18])
    np.testing.assert_allclose(found.test, [3.5 / 3, -0.5])
    num_frames = len(ERRORS) / PAIRS_PER_FRAME
    np.testing.assert_allclose(found.score, [6 * 3.5 / 3 / num_frames, -18 * 0.5 / num_frames])
    assert found.num_tracks.tolist() == [2, 1]


@pytest.mark.parametrize("repeated", [2, 5])
def test_more_pairs_of_the_same_evidence_have_the_same_score(repeated):
    few, many = (
        score_groups(np.array([0, 0, 1, -1]), 2, VISIBLE, np.tile(ERRORS, (n, 1)), np.tile(TESTS, (n, 1)), 12.0)
        for n in (1, repeated)
    )
    np.testing.assert_allclose(few.score, many.score)
    assert few.score[0] > 0


def test_observations_are_the_frames_in_which_the_tracks_are_visible():
    visible = VISIBLE.copy()
    visible[1, 2:] = False
    found = score_groups(np.array([0, 0, 1, -1]), 2, visible, ERRORS, TESTS, max_error=12.0)
    assert found.num_observations.tolist() == [7, 5]
    assert found.num_observations.dtype == np.int64


def test_an_error_counts_up_to_the_largest_one():
    assert score_groups(np.array([-1, -1, -1, 0]), 1, VISIBLE, ERRORS, TESTS, max_error=12.0).strength == 24


@pytest.mark.parametrize("errors", [ERRORS, ERRORS[:0]])
def test_a_group_without_tracks_or_pairs_has_no_score(errors):
    found = score_groups(np.array([-1, 2, -1, -1]), 4, VISIBLE, errors, TESTS[: len(errors)], max_error=12.0)
    assert found.score[[0, 1, 3]].tolist() == found.test[[0, 1, 3]].tolist() == [0, 0, 0]
    assert np.isfinite(found.score).all()
    assert (found.score[2] > 0) == (len(errors) > 0)
    assert found.num_tracks.tolist() == [0, 0, 1, 0]


def test_no_tracks_give_no_scores():
    nothing = np.zeros((0, 0))
    found = score_groups(np.zeros(0, int), 0, np.zeros((0, 0), bool), nothing, nothing, max_error=12.0)
    assert {values.shape for values in found} == {(0,)}
