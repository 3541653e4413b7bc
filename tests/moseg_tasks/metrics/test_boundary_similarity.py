"""Boundary F agrees with distances measured pixel by pixel."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.ndimage import distance_transform_edt

from moseg.tasks.metrics import BOUNDARY_TOLERANCE, boundary_map, boundary_similarity

masks = arrays(bool, (9, 12), elements=st.booleans())


def naive_boundary(mask):
    """Pixels whose right, lower or lower right neighbour, where inside the frame, is on the other side."""
    height, width = mask.shape
    boundary = np.zeros_like(mask)
    for y in range(height):
        for x in range(width):
            for dy, dx in ((0, 1), (1, 0), (1, 1)):
                if y + dy < height and x + dx < width and mask[y, x] != mask[y + dy, x + dx]:
                    boundary[y, x] = True
    return boundary


def naive_similarity(predicted, truth, radius):
    predicted_boundary, true_boundary = naive_boundary(predicted), naive_boundary(truth)
    if not predicted_boundary.any() or not true_boundary.any():
        return float(predicted_boundary.any() == true_boundary.any())
    to_true = distance_transform_edt(~true_boundary)
    to_predicted = distance_transform_edt(~predicted_boundary)
    precision = (to_true[predicted_boundary] <= radius).mean()
    recall = (to_predicted[true_boundary] <= radius).mean()
    return 2 * precision * recall / (precision + recall) if precision + recall else 0.0


@settings(max_examples=60, deadline=None)
@given(masks)
def test_boundary_map_equals_the_naive_one(mask):
    np.testing.assert_array_equal(boundary_map(mask), naive_boundary(mask))


@settings(max_examples=80, deadline=None)
@given(masks, masks, st.integers(1, 4))
def test_similarity_equals_the_naive_one(predicted, truth, radius):
    # Sparse masks leave boundaries that don't match; the product of two draws is sparse.
    sparse = predicted & np.roll(truth, 3, axis=1) & np.roll(truth, 5, axis=0)
    tolerance = (radius - 0.5) / math.hypot(*truth.shape)
    assert boundary_similarity(predicted, truth, tolerance) == pytest.approx(naive_similarity(predicted, truth, radius))
    assert boundary_similarity(sparse, truth, tolerance) == pytest.approx(naive_similarity(sparse, truth, radius))


def disc(centre, radius, shape=(120, 160)):
    y, x = np.indices(shape)
    return (y - centre[0]) ** 2 + (x - centre[1]) ** 2 <= radius**2


@pytest.mark.parametrize("shift", [0, 1, 2, 3, 8])
def test_similarity_of_shifted_discs_equals_the_naive_one(shift):
    truth, predicted = disc((60, 75), 20), disc((60, 75 + shift), 20)
    radius = math.ceil(BOUNDARY_TOLERANCE * 200)
    assert radius == 2
    assert boundary_similarity(predicted, truth) == pytest.approx(naive_similarity(predicted, truth, radius))


def test_masks_at_the_frame_border_equal_the_naive_one():
    truth, predicted = disc((119, 159), 45), disc((117, 159), 43)
    assert boundary_similarity(disc((0, 0), 30), truth) == 0
    assert boundary_similarity(predicted, truth) == pytest.approx(naive_similarity(predicted, truth, 2))


def test_a_shift_within_the_tolerance_has_no_effect():
    assert boundary_similarity(disc((50, 50), 15), disc((50, 52), 15)) == 1
    assert boundary_similarity(disc((50, 50), 15), disc((50, 53), 15)) < 1


def test_swapping_the_masks_changes_nothing():
    first, second = disc((50, 50), 15), disc((52, 57), 12)
    assert boundary_similarity(first, second) == pytest.approx(boundary_similarity(second, first))


def test_empty_masks():
    empty, full = np.zeros((8, 8), bool), np.ones((8, 8), bool)
    assert boundary_similarity(empty, empty) == 1
    assert boundary_similarity(full, empty) == 1
    assert boundary_similarity(disc((4, 4), 2, (8, 8)), empty) == 0
