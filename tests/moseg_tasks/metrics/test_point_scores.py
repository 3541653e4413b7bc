"""Scores over labelled points are those over pixels, with points for pixels."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from moseg.schemas.errors import InputError
from moseg.tasks.metrics import sample_points, score_points, score_sequence

SHAPE = (3, 5, 6)
MEASURES = ("P", "R", "F", "J", "J_objects")


def label_volumes(labels):
    return arrays(np.uint16, SHAPE, elements=st.sampled_from(labels))


def at_every_pixel(predicted, truth):
    """The pairs of a frame whose points are all of its pixels."""
    y, x = np.indices(predicted.shape).reshape(2, -1)
    points = np.stack([x, y], axis=1).astype(float)
    return sample_points(predicted, points, np.ones(len(points), bool), truth.ravel())


def measures(score):
    return [getattr(score, name) for name in MEASURES]


def over_points(predicted, truth):
    """Scores of arrays (frame, point)."""
    return score_points(zip(np.uint16(predicted), np.uint16(truth), strict=True))


@settings(max_examples=100, deadline=None)
@given(label_volumes([0, 0, 1, 2, 9]), label_volumes([0, 0, 1, 2, 3]))
def test_points_at_every_pixel_score_as_masks_do(predicted, truth):
    points = score_points(map(at_every_pixel, predicted, truth))
    assert measures(points) == pytest.approx(measures(score_sequence(lambda: zip(predicted, truth, strict=True))))


def test_points_drawn_evenly_estimate_the_scores_of_masks():
    rng = np.random.default_rng(0)
    truth, predicted = np.zeros((2, 6, 120, 160), np.uint16)
    for frame in range(6):
        truth[frame, 20:70, 10 + frame : 60 + frame] = 2
        truth[frame, 60:110, 90 - frame : 150 - frame] = 3
        predicted[frame, 25:80, 16 + frame : 66 + frame] = 7
        predicted[frame, 70:110, 80 - frame : 140 - frame] = 4
    pairs = []
    for labels, labels_true in zip(predicted, truth, strict=True):
        points = rng.uniform((-0.5, -0.5), (159.49, 119.49), (4000, 2))
        x, y = np.rint(points).astype(int).T
        pairs.append(sample_points(labels, points, np.ones(4000, bool), labels_true[y, x]))
    dense = score_sequence(lambda: zip(predicted, truth, strict=True))
    # Six standard errors of a share of a few thousand points.
    assert measures(score_points(pairs)) == pytest.approx(measures(dense), abs=3)


def test_a_point_takes_the_label_of_the_pixel_around_it_and_only_where_it_is_visible():
    labels = np.arange(12, dtype=np.uint16).reshape(3, 4)
    points = np.array([[0, 0], [-0.5, -0.5], [0.49, 0], [0.5, 0], [3.49, 2.49], [2, 1], [99, 99]])
    visible = np.array([True] * 6 + [False])
    predicted, truth = sample_points(labels, points, visible, np.arange(7, dtype=np.uint16))
    assert predicted.tolist() == [0, 0, 0, 1, 11, 6]
    assert (predicted.dtype, truth.tolist()) == (np.uint16, [0, 1, 2, 3, 4, 5])


def test_a_perfect_prediction_under_other_names_is_perfect():
    truth = np.tile([0, 0, 2, 2, 5, 3], (4, 1))
    assert measures(over_points((truth + 1) * (truth > 0), truth)) == [100] * 5


def test_an_empty_prediction_scores_zero():
    truth = np.tile([0, 2, 2, 3], (4, 1))
    assert measures(over_points(np.zeros((4, 4)), truth)) == [0] * 5


@pytest.mark.parametrize(("predicted", "expected"), [(0, [100] * 5), (1, [0] * 5)])
def test_without_moving_objects_only_an_empty_prediction_is_correct(predicted, expected):
    assert measures(over_points(np.full((3, 4), predicted), np.zeros((3, 4)))) == expected


def test_a_partner_counts_over_all_frames_and_the_rest_is_false():
    # Object 8 is on two of three points of label 2; object 9 on the third, and on one that is static.
    truth = [[2, 2, 0, 0], [2, 0, 0, 0]]
    predicted = [[8, 8, 0, 0], [9, 9, 0, 0]]
    score = over_points(predicted, truth)
    assert measures(score) == pytest.approx([50, 200 / 3, 400 / 7, 75, 50])


def test_frames_without_points_are_left_out():
    empty = np.zeros(0, np.uint16)
    pairs = [(np.uint16([1, 0]), np.uint16([2, 2])), (empty, empty)]
    assert score_points(pairs) == score_points(pairs[:1])
    with pytest.raises(InputError, match="no labelled point to score"):
        score_points([(empty, empty)])


def test_boundaries_are_not_measured():
    score = over_points([[1, 0]], [[1, 0]])
    assert (score.boundary_F, score.boundary_F_objects) == (None, None)
