"""Correlation and contrast of patches."""

import numpy as np
import pytest

from moseg.tasks.object_points.patches import contrast, correlate_patches

NOISE = np.random.default_rng(1).integers(0, 255, (60, 80)).astype(np.uint8)
POINTS = np.float32([[20, 20], [40.5, 30.25], [1, 58]])


def test_a_patch_correlates_with_itself_whatever_its_brightness_and_contrast():
    darker = (NOISE // 2 + 30).astype(np.uint8)
    np.testing.assert_allclose(correlate_patches(NOISE, POINTS, darker, POINTS, 9), 1, atol=0.01)


def test_patches_of_other_places_do_not_correlate():
    assert np.abs(correlate_patches(NOISE, POINTS[:2], NOISE, POINTS[:2] + np.float32([9, 4]), 15)).max() < 0.3


def test_plain_patches_have_a_correlation_of_zero():
    plain = np.full((60, 80), 90, np.uint8)
    np.testing.assert_array_equal(correlate_patches(plain, POINTS, NOISE, POINTS, 9), 0)


def test_contrast_is_the_deviation_of_a_patch():
    expected = [NOISE[16:25, 16:25].std(), NOISE[36:45, 46:55].std()]
    np.testing.assert_allclose(contrast(NOISE, np.float32([[20, 20], [50, 40]]), 9), expected, rtol=1e-4)
    np.testing.assert_array_equal(contrast(np.full((60, 80), 90, np.uint8), POINTS, 9), 0)


@pytest.mark.parametrize("function", ["correlation", "contrast"])
def test_no_points_have_no_patches(function):
    none = np.zeros((0, 2), np.float32)
    found = {
        "correlation": lambda: correlate_patches(NOISE, none, NOISE, none, 9),
        "contrast": lambda: contrast(NOISE, none, 9),
    }[function]()
    assert found.shape == (0,)


def test_more_points_than_opencv_samples_at_once():
    many = np.tile(POINTS, (11_000, 1))
    assert len(many) > 2**15
    found = correlate_patches(NOISE, many, NOISE, many + np.float32([2, 1]), 5)
    expected = correlate_patches(NOISE, POINTS, NOISE, POINTS + np.float32([2, 1]), 5)
    np.testing.assert_array_equal(found, np.tile(expected, 11_000))
