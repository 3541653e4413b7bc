"""Counts of false pixels and false frames where nothing moves."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from moseg.schemas.errors import InputError
from moseg.schemas.scores import StillScore, mean_score
from moseg.tasks.metrics import score_still


def test_a_hand_count():
    frames = np.zeros((4, 5, 10), np.uint16)
    frames[1, 0, :3] = 7
    frames[3, 2:4, 5] = 1, 9
    assert score_still(frames) == StillScore(false_pixels=2.5, false_frames=50)


def test_nothing_labelled_is_without_error_and_everything_is_all_wrong():
    assert score_still(np.zeros((2, 3, 4), np.uint8)) == StillScore(false_pixels=0, false_frames=0)
    assert score_still(np.ones((2, 3, 4), np.uint8)) == StillScore(false_pixels=100, false_frames=100)


@given(arrays(np.uint16, (3, 4, 5), elements=st.sampled_from([0, 0, 1, 2])), st.permutations(range(3)))
def test_neither_the_order_of_frames_nor_the_labels_count(labels, order):
    assert score_still(labels[list(order)] * 5) == score_still(labels)


def test_the_mean_is_over_sequences_not_over_frames():
    scores = [score_still(np.ones((9, 2, 2), np.uint8)), score_still(np.zeros((1, 8, 8), np.uint8))]
    assert mean_score(scores) == StillScore(false_pixels=50, false_frames=50)


@pytest.mark.parametrize(("frames", "message"), [([], "no frame"), ([np.zeros((2, 2))], "not a label image")])
def test_what_is_no_segmentation_is_refused(frames, message):
    with pytest.raises(InputError, match=message):
        score_still(frames)
