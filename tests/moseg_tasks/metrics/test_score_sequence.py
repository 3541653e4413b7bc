"""Scores agree with a brute-force reading of their definitions."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from moseg.schemas.errors import InputError
from moseg.tasks.metrics import boundary_similarity, score_sequence
from moseg.tasks.metrics.assign_objects import assign_objects

VOID = 255
SHAPE = (3, 5, 6)


def label_volumes(labels):
    return arrays(np.uint16, SHAPE, elements=st.sampled_from(labels))


def score(predicted, truth, void=VOID):
    return score_sequence(lambda: zip(predicted, truth, strict=True), void)


def foreground(result):
    return [getattr(result, name) for name in "PRF"]


def voxels(volume, label, void_mask):
    return {tuple(i) for i in np.argwhere((volume == label) & ~void_mask)}


def brute_force_foreground(predicted, truth, void=VOID):
    """Every one-to-one assignment is tried; the best sum of F-measures, then the most shared voxels, wins."""
    void_mask = truth == void
    true_objects = [voxels(truth, g, void_mask) for g in np.unique(truth) if g not in (0, void)]
    predicted_objects = [voxels(predicted, c, void_mask) for c in np.unique(predicted) if c != 0]
    num_true = sum(map(len, true_objects))
    num_predicted = sum(map(len, predicted_objects))
    if num_true == num_predicted == 0:
        return [100.0, 100.0, 100.0]
    size = max(len(true_objects), len(predicted_objects))
    true_objects += [set()] * (size - len(true_objects))
    predicted_objects += [set()] * (size - len(predicted_objects))
    best = (-1.0, 0)
    for order in itertools.permutations(range(size)):
        pairs = [(true_objects[i], predicted_objects[j]) for i, j in enumerate(order)]
        total = sum(2 * len(g & c) / (len(g) + len(c)) for g, c in pairs if g or c)
        best = max(best, (round(total, 9), sum(len(g & c) for g, c in pairs)))
    shared = best[1]
    precision = 100 * shared / num_predicted if num_predicted else 0.0
    recall = 100 * shared / num_true if num_true else 0.0
    return [precision, recall, 2 * precision * recall / (precision + recall) if shared else 0.0]


def brute_force_region(predicted, truth, void=VOID):
    values = []
    for predicted_frame, true_frame in zip(predicted, truth, strict=True):
        intersection = union = 0
        for c, g in zip(predicted_frame.flat, true_frame.flat, strict=True):
            if g != void:
                intersection += c > 0 and g > 0
                union += c > 0 or g > 0
        values.append(intersection / union if union else 1.0)
    return 100 * sum(values) / len(values)


@settings(max_examples=60, deadline=None)
@given(label_volumes([0, 1, 2, 3, 9]), label_volumes([0, 0, 1, 2, VOID]))
def test_scores_equal_the_brute_force_ones(predicted, truth):
    result = score(predicted, truth)
    assert foreground(result) == pytest.approx(brute_force_foreground(predicted, truth))
    assert math.isclose(result.J, brute_force_region(predicted, truth))


@settings(max_examples=40, deadline=None)
@given(label_volumes([0, 0, 0, 4]), label_volumes([0, 1, 2, 3]))
def test_fewer_predictions_than_objects_equal_the_brute_force_ones(predicted, truth):
    result = score(predicted, truth, void=None)
    assert foreground(result) == pytest.approx(brute_force_foreground(predicted, truth, void=-1))


@settings(max_examples=40, deadline=None)
@given(label_volumes([0, 1, 2, 3]), label_volumes([0, 1, 2, VOID]), st.permutations([1, 2, 3]), st.permutations([1, 2]))
def test_numbering_of_objects_does_not_matter(predicted, truth, predicted_order, true_order):
    renumbered = np.array([0, *predicted_order], dtype=np.uint16)[predicted] * 7
    names = np.arange(VOID + 1, dtype=np.uint16)
    names[1:3] = true_order
    first, second = score(predicted, truth), score(renumbered, names[truth])
    for field in ("P", "R", "F", "J", "boundary_F"):
        assert getattr(first, field) == pytest.approx(getattr(second, field))


@settings(max_examples=30, deadline=None)
@given(label_volumes([0, 1, 2, VOID]), label_volumes([0, 1, 2, 3]))
def test_what_is_predicted_in_void_does_not_matter(truth, predicted):
    assume((truth == VOID).any())
    changed = np.where(truth == VOID, (predicted + 1) % 4, predicted).astype(np.uint16)
    assert score(predicted, truth) == score(changed, truth)


@settings(max_examples=20, deadline=None)
@given(label_volumes([0, 1, 2, 5]))
def test_a_perfect_prediction_scores_100(truth):
    result = score((truth * 3).astype(np.uint16), truth)
    assert all(value == pytest.approx(100) for value in result.model_dump().values())


def two_objects():
    """Two objects of 4x4 px in two frames of 10x20 px; the second is gone in the second frame."""
    truth = np.zeros((2, 10, 20), dtype=np.uint16)
    truth[:, 3:7, 2:6] = 1
    truth[0, 3:7, 12:16] = 2
    return truth


def test_objects_are_scored_under_their_assignment():
    truth = two_objects()
    predicted = np.zeros_like(truth)
    predicted[:, 3:7, 4:8] = 8
    result = score(predicted, truth)
    # Object 1 keeps 2 of its 4 columns and gains 2: J = 1/3 in both frames; object 2 has no partner: 0, then 1.
    assert result.J_objects == pytest.approx(100 * (1 / 3 + 1 / 3 + 0 + 1) / 4)
    assert foreground(result) == pytest.approx([50, 100 * 16 / 48, 40])
    of_object_1 = boundary_similarity(predicted[0] == 8, truth[0] == 1)
    assert 0 < of_object_1 < 1
    assert result.boundary_F_objects == pytest.approx(100 * (2 * of_object_1 + 0 + 1) / 4)


def test_a_prediction_without_a_partner_is_a_false_positive():
    truth = two_objects()
    predicted = truth.copy()
    predicted[1, 3:7, 12:16] = 3
    result = score(predicted, truth)
    assert foreground(result) == pytest.approx([100 * 48 / 64, 100, 100 * 6 / 7])
    assert result.J_objects == result.boundary_F_objects == 100
    assert result.J == 75


def test_splitting_an_object_costs_precision_and_recall_but_not_j():
    truth = two_objects()
    predicted = truth.copy()
    predicted[:, 3:7, 2:4] = 9
    result = score(predicted, truth)
    assert result.P == result.R == pytest.approx(100 * 32 / 48)
    assert result.J == 100


@pytest.mark.parametrize(("predict", "expected"), [(False, 100), (True, 0)])
def test_nothing_to_find(predict, expected):
    truth = np.zeros((2, 6, 8), dtype=np.uint16)
    predicted = truth.copy()
    if predict:
        predicted[:, 2:4, 2:4] = 1
    assert set(score(predicted, truth).model_dump().values()) == {expected}


def test_an_empty_prediction_scores_0_but_for_frames_without_the_object():
    truth = two_objects()
    result = score(np.zeros_like(truth), truth)
    assert (result.P, result.R, result.F, result.J, result.boundary_F) == (0, 0, 0, 0, 0)
    assert result.J_objects == result.boundary_F_objects == 25


def test_label_255_is_an_object_without_a_void_label():
    truth = two_objects() // 2 * 255
    result = score(truth, truth, void=None)
    assert result.P == result.R == 100
    assert score(np.zeros_like(truth), truth, void=None).J == 50
    assert score(np.zeros_like(truth), truth, void=255).J == 100


def test_sizes_that_differ_are_named():
    with pytest.raises(InputError, match=r"got \(4, 5\); expected \(4, 6\)"):
        score(np.zeros((1, 4, 5), np.uint16), np.zeros((1, 4, 6), np.uint16))


def test_float_labels_are_refused():
    with pytest.raises(InputError, match="not a label image in prediction; got float64"):
        score(np.zeros((1, 4, 5)), np.zeros((1, 4, 5), np.uint16))


def test_no_frame_is_refused():
    with pytest.raises(InputError, match="no annotated frame"):
        score_sequence(list)


@pytest.mark.parametrize(("small", "large"), [(1, 2), (2, 1)])
def test_of_equal_sums_the_assignment_with_most_pixels_is_taken(small, large):
    # 2 * 10 / (10 + 30) = 2 * 20 / (50 + 30)
    assert assign_objects({(small, 1): 10, (large, 1): 20, (large, 0): 30}) == {large: 1}
