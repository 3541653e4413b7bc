import numpy as np
import pytest

from moseg.schemas.parameters import FlowParams
from moseg.tasks.flow import estimate_flow
from moseg.tasks.training_scenes import draw_scene, paint_textures
from moseg.tasks.training_scenes.camera import CameraStep, camera_flow
from moseg.tasks.training_scenes.layers import MARGIN, Layer, add_layer, canvas_points, empty_canvas
from moseg.tasks.training_scenes.movers import OwnMotion, own_displacement
from moseg.tasks.training_scenes.surfaces import draw_surfaces

SHAPE = (96, 160)


@pytest.fixture(scope="module")
def textures():
    return paint_textures(0, 8)


def test_the_same_seed_draws_the_same_scene(textures):
    first, second = (draw_scene(np.random.default_rng(3), SHAPE, textures) for _ in range(2))
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a, b)
    other = draw_scene(np.random.default_rng(4), SHAPE, textures)
    assert (other.frames != first.frames).any()


def test_scenes_have_frames_and_a_label_that_is_a_share(textures):
    moving = []
    for index in range(12):
        scene = draw_scene(np.random.default_rng([1, index]), SHAPE, textures)
        assert scene.frames.dtype == np.uint8 and scene.frames.shape == (3, *SHAPE, 3)
        assert scene.label.shape == scene.weight.shape == SHAPE
        assert scene.label.min() >= 0 and scene.label.max() <= 1 + 1e-5
        moving.append(float(scene.label.mean()))
    # Not all alike: scenes in which little or nothing moves, and scenes in which much does.
    assert min(moving) < 0.02 and max(moving) > 0.1


def test_textures_differ_and_repeat_without_a_seam(textures):
    assert len(np.unique(textures.reshape(len(textures), -1), axis=0)) == len(textures)
    noise = textures.astype(float)
    seam = np.abs(noise[:, :, 0] - noise[:, :, -1]).mean()
    inside = np.abs(np.diff(noise, axis=2)).mean()
    assert seam < 2 * inside + 1


def test_far_points_follow_the_turn_of_a_camera_and_near_points_its_shift():
    step = CameraStep(np.array([4.0, 0.0]), 0.0, np.array([0.0, 3.0]), 0.0, 0.0)
    middle = np.zeros((1, 1, 2), np.float32)
    far, near = (camera_flow(step, np.full((1, 1), depth, np.float32), middle, 160.0)[0, 0] for depth in (0, 1))
    np.testing.assert_allclose(far, [4, 0], atol=1e-6)
    np.testing.assert_allclose(near, [4, 3], atol=1e-6)


def test_a_camera_that_moves_ahead_spreads_near_points_from_the_middle():
    step = CameraStep(np.zeros(2), 0.0, np.zeros(2), 0.1, 0.0)
    points = np.array([[[50.0, -20.0]]], np.float32)
    flow = camera_flow(step, np.ones((1, 1), np.float32), points, 160.0)
    np.testing.assert_allclose(flow, 0.1 * points, rtol=1e-5)


def test_inverse_depth_of_surfaces_is_limited():
    for index in range(20):
        depth = draw_surfaces(np.random.default_rng(index), canvas_points(SHAPE), 160.0)
        assert depth.shape == (SHAPE[0] + 2 * MARGIN, SHAPE[1] + 2 * MARGIN)
        assert depth.min() >= 0 and depth.max() <= 1.2


def test_a_layer_is_where_its_displacement_says(textures):
    """The displacement is inverted where a pixel is seen, so that the flow of the frames is the given one."""
    canvas = empty_canvas(SHAPE)

    def still(step, points):
        return np.zeros_like(points)

    def moving(step, points):
        return step * (np.array([5.0, 2.0], np.float32) + 0.05 * points)

    alpha = np.zeros(canvas_points(SHAPE).shape[:2], np.uint8)
    alpha[MARGIN + 30 : MARGIN + 70, MARGIN + 50 : MARGIN + 110] = 255
    chart = np.eye(2, 3)
    add_layer(canvas, Layer(None, still, textures[0], chart))
    add_layer(canvas, Layer(alpha, moving, textures[1], chart, moves=1.0))
    assert canvas.label[30:70, 50:110].min() == 1 and canvas.label[:25].max() == 0
    frames = np.clip(np.rint(canvas.frames), 0, 255).astype(np.uint8)
    flow = estimate_flow(frames[1], frames[2], FlowParams(preset="fine"))
    y, x = np.mgrid[40:60, 60:100]
    expected = np.stack([5 + 0.05 * (x - 80), 2 + 0.05 * (y - 48)], axis=-1)
    assert np.median(np.abs(flow[40:60, 60:100] - expected)) < 0.3
    assert np.median(np.abs(flow[:20])) < 0.1


def test_feet_stay_while_the_body_moves():
    own = OwnMotion(np.array([[-3.0, 0], [3.0, 0]]), np.zeros(2), np.zeros(2), np.zeros(2), None, (10.0, 20.0))
    points = np.array([[[0.0, 0.0], [0.0, 15.0], [0.0, 30.0]]], np.float32)
    moved = own_displacement(own, 1, points, SHAPE, None, 0.0)[0]
    np.testing.assert_allclose(moved[:, 0], [3, 1.5, 0], atol=1e-6)
