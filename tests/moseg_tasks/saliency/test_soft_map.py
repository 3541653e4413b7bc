"""Soft map of residual motion: what counts beside large and fast things."""

import numpy as np
import pytest

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.soft_map import soft_map

PARAMS = SaliencyParams()
SHAPE = (120, 160)
LARGE, SMALL = np.s_[20:90, 20:80], np.s_[40:60, 120:140]
STILL = np.zeros(SHAPE, np.float32)


def residual(large, small):
    """Return the residual motion of a large and a small thing, px/frame."""
    found = np.full(SHAPE, 0.02, np.float32)
    found[LARGE], found[SMALL] = large, small
    return found


def saliency(large, small, **background):
    """Return the saliency in the middle of both, and where nothing moves."""
    found = soft_map(residual(large, small), STILL, PARAMS, **{"is_rigid": False, **background})
    assert found.dtype == np.float32
    return found[55, 50], found[50, 130], found[110, 10]


def test_a_small_slow_thing_counts_beside_a_large_fast_one_before_a_camera_at_rest():
    large, small, nothing = saliency(12.0, 0.5, is_at_rest=True)
    assert large > 0.8 and small > 0.7 and nothing < 0.01
    assert saliency(12.0, 0.5)[1] < 0.55


@pytest.mark.parametrize("speeds", [(12.0, 0.8), (3.0, 3.0), (1.0, 0.02), (0.3, 0.1)])
def test_at_rest_nothing_counts_less_than_by_one_threshold_for_the_frame(speeds):
    values = residual(*speeds)
    at_rest, layers = (soft_map(values, STILL, PARAMS, False, each) for each in (True, False))
    assert (at_rest >= layers).all()


def test_what_is_below_the_floor_counts_little_at_rest():
    assert max(saliency(0.15, 0.1, is_at_rest=True)) < 0.25


def test_a_rigid_background_knows_no_threshold_for_the_frame():
    large, small, _ = saliency(12.0, 0.8, is_rigid=True)
    assert large == pytest.approx(1 / (1 + PARAMS.outline_share**2), rel=1e-3) and small > 0.8
