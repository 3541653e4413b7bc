"""Affine motion of the pixels of a region."""

import numpy as np
import pytest

from moseg.tasks.saliency.affine_fit import fit_affine

SHAPE = (60, 90)
MOTION = np.array([[0.02, -0.01, 1.5], [0.03, -0.04, -2.0]])
REGION = np.zeros(SHAPE, bool)
REGION[10:40, 20:70] = True


def flow_of(motion):
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]].astype(float)
    return (np.stack([x, y, np.ones(SHAPE)], axis=-1) @ motion.T).astype(np.float32)


def test_the_motion_of_the_region_is_found_whatever_is_around_it():
    flow = np.where(REGION[..., None], flow_of(MOTION), np.float32(30))
    np.testing.assert_allclose(fit_affine(flow, REGION), MOTION, atol=1e-4)


def test_scattered_pixels_may_move_otherwise():
    flow = flow_of(MOTION)
    flow[np.random.default_rng(0).random(SHAPE) < 0.2] += 9
    np.testing.assert_allclose(fit_affine(flow, REGION)[:, :2], MOTION[:, :2], atol=2e-3)


def test_pixels_in_a_row_have_no_gradient_across_it():
    row = np.zeros(SHAPE, bool)
    row[20, 10:60] = True
    found = fit_affine(flow_of(MOTION), row)
    np.testing.assert_allclose(found[:, 0], MOTION[:, 0], atol=1e-3)
    np.testing.assert_allclose(found[:, 1], 0, atol=1e-6)


@pytest.mark.parametrize(("number", "is_found"), [(0, False), (11, False), (12, True)])
def test_a_few_pixels_have_no_motion(number, is_found):
    few = np.zeros(SHAPE, bool)
    few.reshape(-1)[np.arange(number) * 91] = True
    assert (fit_affine(flow_of(MOTION), few) is not None) == is_found
