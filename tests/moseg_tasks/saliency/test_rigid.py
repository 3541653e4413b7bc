"""Worlds of inverse depth over a ground, seen by a camera that slides sideways: parallax is inverse depth itself."""

import numpy as np
import pytest

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.camera import CameraMotion
from moseg.tasks.saliency.ground import fit_ground
from moseg.tasks.saliency.rigid import explain_rigidly
from moseg.tasks.saliency.support import unsupported_parallax

PARAMS = SaliencyParams()
SHAPE = (120, 200)
HORIZON, SLOPE = 48, 0.06
SLIDING = CameraMotion(np.eye(3), np.array([-1.0, 0.0, 0.0]), 200.0)
BOX = (slice(50, 80), slice(80, 120))
WALL = 0.4


def world() -> np.ndarray:
    """Parallax, px/frame, of a ground up to a wall."""
    ground = SLOPE * (np.arange(SHAPE[0], dtype=np.float32) - HORIZON)
    return np.tile(np.maximum(ground, WALL)[:, None], (1, SHAPE[1]))


def on_the_ground() -> np.ndarray:
    """The same with a box whose lower edge stands on the ground."""
    parallax = world()
    parallax[BOX] = SLOPE * (BOX[0].stop - HORIZON)
    return parallax


def residual(parallax: np.ndarray, across: float = 0.0) -> np.ndarray:
    flow = np.dstack([-parallax, np.zeros_like(parallax)]).astype(np.float32)
    flow[BOX] += np.array([0.0, across], np.float32)
    return explain_rigidly(flow, SLIDING, PARAMS).residual


def test_a_static_world_of_any_depth_leaves_nothing():
    assert residual(world()).max() < 1e-4
    assert residual(on_the_ground()).max() < 0.05


def test_motion_across_the_epipolar_lines_is_left_whole():
    left = residual(on_the_ground(), across=0.4)
    np.testing.assert_allclose(left[BOX][:, 2:-2], 0.4, atol=0.05)
    assert left[:, :60].max() < 0.05


def test_a_floating_thing_moves_along_its_epipolar_line():
    parallax = world()
    parallax[BOX] = 5.0
    left = residual(parallax)
    assert left[BOX].min() > 2.5
    left[BOX] = 0
    assert left.max() < 0.05


def test_a_thing_under_the_ground_moves_along_its_epipolar_line():
    parallax = world()
    parallax[60:90, 80:120] = -1.0
    left = residual(parallax)
    assert left[60:90, 80:120].min() > 1.0
    assert left[:, :60].max() < 0.05


def test_a_thing_whose_foot_is_hidden_may_be_static():
    parallax = on_the_ground()
    parallax[20:50, 85:115] = 1.0  # nearer than the wall, seen above the box
    assert residual(parallax).max() < 0.05


def test_the_background_s_flow_is_that_of_the_static_world_behind_a_mover():
    flow = np.dstack([-world(), np.zeros(SHAPE, np.float32)])
    moving = flow.copy()
    moving[BOX] += np.array([-3.0, 1.0], np.float32)
    found = explain_rigidly(moving, SLIDING, PARAMS).flow
    assert np.abs(found[..., 1]).max() < 1e-4
    assert np.abs(found - flow)[BOX].max() < 1.5


def test_the_support_of_a_pixel_is_the_cheapest_way_up_or_sideways():
    inverse_depth = np.array([[5, 5, 0], [5, 9, 0], [1, 1, 0]], np.float32)
    ones, zeros = np.ones((3, 3), np.float32), np.zeros((3, 3), np.float32)
    expected = [[4, 4, 0], [4, 8, 0], [0, 0, 0]]
    np.testing.assert_array_equal(unsupported_parallax(inverse_depth, ones, zeros, zeros), expected)
    np.testing.assert_array_equal(unsupported_parallax(inverse_depth, ones, zeros, 3 * ones)[1], [1, 2, 0])


def test_what_is_buried_hides_what_stands_on_it():
    ones, zeros = np.ones((4, 1), np.float32), np.zeros((4, 1), np.float32)
    buried = np.array([[0], [0], [3], [0]], np.float32)
    np.testing.assert_array_equal(unsupported_parallax(ones, ones, buried, zeros).ravel(), [3, 3, 3, 0])


def test_the_ground_is_found_under_what_stands_on_it():
    parallax = on_the_ground()
    parallax[50:100, 20:50] = 6.0
    ground = fit_ground(parallax, np.ones(SHAPE, np.float32), PARAMS)
    np.testing.assert_allclose(ground.plane, [-SLOPE * HORIZON, 0, SLOPE], rtol=0.05, atol=1e-3)
    assert ground.tilt < 0.01 and 0.7 < ground.share < 1
    assert ground.approach == pytest.approx(SLOPE * 48, rel=0.05)
    np.testing.assert_allclose(ground.inverse_depth(SHAPE)[100:], world()[100:], atol=0.1)


def test_a_wall_that_faces_the_camera_comes_no_nearer_below():
    assert abs(fit_ground(np.full(SHAPE, 2.0, np.float32), np.ones(SHAPE, np.float32), PARAMS).approach) < 1e-6


@pytest.mark.parametrize("shape", [(1, 1), (2, 1), (1, 30), (9, 9)])
def test_the_smallest_frames_have_some_ground(shape):
    ground = fit_ground(np.ones(shape, np.float32), np.ones(shape, np.float32), PARAMS)
    assert np.isfinite(ground.plane).all() and 0 <= ground.share <= 1


def test_a_jump_upwards_is_measured_where_it_ends():
    zeros = np.zeros((2, 1), np.float32)
    found = unsupported_parallax(np.float32([[2], [1]]), np.float32([[3], [1]]), zeros, zeros)
    assert found.ravel().tolist() == [3, 0]
