"""Each sequence is difficult in the way that its name says."""

import numpy as np
import pytest

from moseg.tasks.synthetic import SCENES, camera_at

HEIGHT, WIDTH = 60, 106
GRID_Y, GRID_X = np.mgrid[:HEIGHT, :WIDTH].astype(np.float64)


def homogeneous(x, y):
    return np.stack([x, y, np.ones_like(x)], axis=-1)


def intrinsics(camera):
    return np.array([[camera.focal, 0, camera.center[0]], [0, camera.focal, camera.center[1]], [0, 0, 1]])


def fundamental(camera0, camera1):
    """F with x1' F x0 = 0 for a static world."""
    rotation = camera1.pose.rotation.T @ camera0.pose.rotation
    tx, ty, tz = camera1.pose.rotation.T @ (camera0.pose.translation - camera1.pose.translation)
    cross = np.array([[0, -tz, ty], [tz, 0, -tx], [-ty, tx, 0]])
    return np.linalg.inv(intrinsics(camera1)).T @ cross @ rotation @ np.linalg.inv(intrinsics(camera0))


def sampson(F, points0, points1):
    """Sampson distance, px."""
    line1, line0 = points0 @ F.T, points1 @ F
    numerator = (points1 * line1).sum(axis=-1)
    return np.abs(numerator) / np.sqrt((line1[..., :2] ** 2).sum(axis=-1) + (line0[..., :2] ** 2).sum(axis=-1))


def epipolar_error(rendered, declared, mask):
    cameras = [camera_at(declared.camera, t, declared.height, declared.width) for t in (0, 1)]
    flow = rendered.flow_forward[0].astype(np.float64)
    y, x = np.mgrid[: declared.height, : declared.width].astype(np.float64)
    points1 = homogeneous(x + flow[..., 0], y + flow[..., 1])
    return sampson(fundamental(*cameras), homogeneous(x, y), points1)[mask]


def quadratic_error(flow, mask):
    """Residual of the best 12-parameter quadratic flow without depth, px."""
    x, y = (GRID_X[mask] - 52.5) / 53, (GRID_Y[mask] - 29.5) / 53
    design = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=1)
    theta = np.linalg.lstsq(design, flow[mask], rcond=None)[0]
    return np.linalg.norm(design @ theta - flow[mask], axis=1)


@pytest.mark.parametrize("name", ["forward-drive-epipolar-car", "parallel-mover"])
def test_mover_stays_on_its_epipolar_lines(name, small, small_scene):
    rendered = small(name)
    assert epipolar_error(rendered, small_scene(name), rendered.moving[0] > 0).max() < 1e-4


def test_epipolar_car_flows_through_the_epipole(small, small_scene):
    rendered, scene = small("forward-drive-epipolar-car"), small_scene("forward-drive-epipolar-car")
    camera0, camera1 = (camera_at(scene.camera, t, HEIGHT, WIDTH) for t in (0, 1))
    ahead = camera0.pose.rotation.T @ (camera1.pose.translation - camera0.pose.translation)
    epipole = camera0.focal * ahead[:2] / ahead[2] + camera0.center
    car = rendered.moving[0] > 0
    flow, out_x, out_y = rendered.flow_forward[0][car], GRID_X[car] - epipole[0], GRID_Y[car] - epipole[1]
    np.testing.assert_allclose(flow[:, 0] * out_y - flow[:, 1] * out_x, 0, atol=1e-4)


def test_other_movers_leave_their_epipolar_lines(small, small_scene):
    rendered = small("two-motions")
    approaching = rendered.moving[0] == 4
    assert np.median(epipolar_error(rendered, small_scene("two-motions"), approaching)) > 0.05


def drive(name, small, small_scene):
    """Render, declaration, and the identity of the largest mover in the first frame."""
    rendered = small(name)
    return rendered, small_scene(name), np.bincount(rendered.moving[0].ravel())[1:].argmax() + 1


def test_oncoming_car_moves_almost_along_its_epipolar_lines(small, small_scene):
    rendered, scene, car = drive("drive-oncoming-car", small, small_scene)
    assert epipolar_error(rendered, scene, rendered.moving[0] == car).max() < 0.05
    areas = (rendered.moving == car).sum(axis=(1, 2))
    assert (np.diff(areas) > 0).all()


def test_overtaking_car_recedes_while_the_one_ahead_stays(small, small_scene):
    rendered, _, car = drive("drive-overtaking-car", small, small_scene)
    receding, ahead = ((rendered.moving == identity).sum(axis=(1, 2)) for identity in (car, car + 1))
    assert receding[-1] < 0.6 * receding[0]
    assert abs(ahead[-1] / ahead[0] - 1.0) < 0.1


def test_crossing_cyclist_is_small_and_leaves_its_epipolar_lines(small, small_scene):
    rendered, scene, rider = drive("drive-crossing-cyclist", small, small_scene)
    assert (rendered.moving > 0).mean() < 0.01
    assert np.median(epipolar_error(rendered, scene, rendered.moving[0] == rider)) > 0.5


def test_parked_cars_share_the_streets_motion(small, small_scene):
    rendered, scene = small("drive-parked-row"), small_scene("drive-parked-row")
    assert epipolar_error(rendered, scene, rendered.objects[0] > 0).max() < 1e-3


@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("drive-")])
def test_drives_have_kittis_camera(name):
    scene = SCENES[name]
    assert abs(scene.width / scene.height - 1242 / 375) < 0.01
    assert abs(scene.camera.position.at(0)[1] + 1.65) < 0.02
    assert 0.5 <= scene.camera.position.velocity[2] <= 1.0


def test_pure_rotation_is_a_homography_whatever_the_depth(small, small_scene):
    rendered = small("pure-rotation")
    camera0, camera1 = (camera_at(small_scene("pure-rotation").camera, t, HEIGHT, WIDTH) for t in (0, 1))
    turn = camera1.pose.rotation.T @ camera0.pose.rotation
    H = intrinsics(camera1) @ turn @ np.linalg.inv(intrinsics(camera0))
    mapped = homogeneous(GRID_X, GRID_Y) @ H.T
    expected = mapped[..., :2] / mapped[..., 2:] - np.stack([GRID_X, GRID_Y], axis=-1)
    static = rendered.moving[0] == 0
    np.testing.assert_allclose(rendered.flow_forward[0][static], expected[static], atol=1e-4)


def test_zoom_spreads_the_static_world(small):
    rendered = small("zoom")
    static = rendered.moving[0] == 0
    outward = (rendered.flow_forward[0] * np.stack([GRID_X - 52.5, GRID_Y - 29.5], axis=-1)).sum(axis=-1)
    assert (outward[static] > 0).mean() > 0.9


@pytest.mark.parametrize("name", ["strong-parallax", "nothing-moves"])
def test_flow_without_depth_does_not_explain_static_things(name, small):
    rendered = small(name)
    static = rendered.moving[0] == 0
    assert np.percentile(quadratic_error(rendered.flow_forward[0], static), 90) > 0.3


def test_flow_without_depth_explains_a_turning_camera(small):
    rendered = small("pure-rotation")
    assert quadratic_error(rendered.flow_forward[0], rendered.moving[0] == 0).max() < 0.02


def test_static_camera_leaves_the_static_world_still(small):
    rendered = small("static-camera")
    static = rendered.moving[0] == 0
    assert np.abs(rendered.flow_forward[0][static]).max() < 1e-6
    assert np.linalg.norm(rendered.flow_forward[0][~static], axis=-1).min() > 0.5


def test_parallel_mover_stands_still_in_the_image(small):
    rendered = small("parallel-mover")
    car = rendered.moving[0] > 0
    assert np.abs(rendered.flow_forward[0][car]).max() < 1e-4
    assert np.linalg.norm(rendered.flow_forward[0][~car], axis=-1).min() > 0.2


def test_brightness_changes_over_the_whole_frame(small):
    levels = small("brightness-change").images.mean(axis=(1, 2))
    assert (levels.max(axis=0) > 1.15 * levels.min(axis=0)).all()
    steady = small("pan").images.mean(axis=(1, 2, 3))
    assert steady.max() < 1.1 * steady.min()


@pytest.mark.parametrize("name", ["nonrigid", "deforming"])
def test_nonrigid_flow_varies_within_the_object(name, small):
    rendered = small(name)
    flow = rendered.flow_forward[1][rendered.moving[1] > 0]
    assert np.ptp(flow[:, 0]) > 0.4


def test_camera_shake_changes_direction(small):
    horizontal = np.median(small("handheld-jitter", 14).flow_forward[..., 0], axis=(1, 2))
    assert (np.diff(np.sign(horizontal)) != 0).sum() >= 3
