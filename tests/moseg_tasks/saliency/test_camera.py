import numpy as np
import pytest

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.camera import fit_camera_motion, split_flow
from moseg.tasks.saliency.grid import pixel_grid

PARAMS = SaliencyParams()
SHAPE = (120, 200)
FOCAL = 1.1
ROTATION = np.array([0.004, -0.01, 0.006])
TRANSLATION = np.array([0.3, 0.05, 0.4])


def depths() -> np.ndarray:
    """A slanted wall with bumps, 4 to 12 units away."""
    x, y = np.moveaxis(pixel_grid(SHAPE), -1, 0)
    return 8.0 + 3 * np.sin(x / 23) + np.cos(y / 11)


def rigid_flow(depth=None, rotation=ROTATION, translation=TRANSLATION) -> np.ndarray:
    """Exact flow of points at `depth` after X' = R X + t."""
    depth = depths() if depth is None else depth
    length, centre = FOCAL * SHAPE[1], [(SHAPE[1] - 1) / 2, (SHAPE[0] - 1) / 2]
    rays = np.dstack([(pixel_grid(SHAPE).astype(np.float64) - centre) / length, np.ones(SHAPE)])
    moved = (rays * depth[..., None]) @ turned(rotation).T + translation
    return (moved[..., :2] / moved[..., 2:] * length + centre - pixel_grid(SHAPE)).astype(np.float32)


def turned(rotation: np.ndarray) -> np.ndarray:
    angle = np.linalg.norm(rotation)
    if angle == 0:
        return np.eye(3)
    x, y, z = rotation / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def test_rotation_and_direction_of_travel_are_recovered():
    motion = fit_camera_motion(rigid_flow(), FOCAL, PARAMS)
    np.testing.assert_allclose(motion.rotation, turned(ROTATION), atol=1e-4)
    np.testing.assert_allclose(motion.translation, TRANSLATION / np.linalg.norm(TRANSLATION), atol=0.02)
    assert motion.focal == FOCAL * SHAPE[1]


def test_flow_of_a_static_scene_has_nothing_across_its_epipolar_lines():
    flow = rigid_flow()
    assert np.abs(split_flow(flow, fit_camera_motion(flow, FOCAL, PARAMS)).across).max() < 0.02


def test_parallax_over_reach_is_inverse_depth():
    flow = rigid_flow()
    parts = split_flow(flow, fit_camera_motion(flow, FOCAL, PARAMS))
    # Exact to first order in t / depth: what is seen closer than expected has moved towards the camera itself.
    expected = np.linalg.norm(TRANSLATION) / depths()
    assert np.corrcoef(parts.along.ravel() / parts.reach.ravel(), expected.ravel())[0, 1] > 0.999


def test_the_parts_make_up_the_flow():
    flow = rigid_flow() + np.float32(0.7)
    motion = fit_camera_motion(rigid_flow(), FOCAL, PARAMS)
    static, moved = split_flow(rigid_flow(), motion), split_flow(flow, motion)
    change = np.hypot(moved.along - static.along, moved.across - static.across)
    np.testing.assert_allclose(change, np.hypot(0.7, 0.7), atol=1e-3)


def test_a_coarse_split_reads_every_step_th_pixel():
    flow = rigid_flow()
    motion = fit_camera_motion(flow, FOCAL, PARAMS)
    for whole, coarse in zip(split_flow(flow, motion), split_flow(flow, motion, 7), strict=True):
        np.testing.assert_array_equal(whole[::7, ::7], coarse)


def test_an_object_on_a_fifth_of_the_frame_does_not_bend_the_camera_s_motion():
    flow = rigid_flow()
    flow[40:100, 60:140] += np.array([2.0, -3.0], np.float32)
    np.testing.assert_allclose(fit_camera_motion(flow, FOCAL, PARAMS).rotation, turned(ROTATION), atol=1e-3)


@pytest.mark.parametrize("shape", [(1, 1), (5, 5), (1, 60), (30, 40)])
def test_frames_with_too_few_samples_show_no_camera_motion(shape):
    assert fit_camera_motion(np.ones((*shape, 2), np.float32), 1.0, PARAMS) is None


def test_the_motion_is_the_same_bytes_each_time():
    flow = rigid_flow() + np.random.default_rng(0).normal(0, 0.2, (*SHAPE, 2)).astype(np.float32)
    first, second = (fit_camera_motion(flow, FOCAL, PARAMS) for _ in range(2))
    assert first.rotation.tobytes() == second.rotation.tobytes()
    assert first.translation.tobytes() == second.translation.tobytes()
