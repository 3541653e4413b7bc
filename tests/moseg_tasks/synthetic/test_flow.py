"""Flow against tracks, against its reverse, against an independent pinhole computation and against the pictures."""

import cv2
import numpy as np
import pytest

from moseg.tasks.synthetic import SCENES, camera_at


def pixels_of(image):
    """Coordinates x and y, float64 (height, width), of an image's pixels."""
    y, x = np.mgrid[: image.shape[0], : image.shape[1]].astype(np.float64)
    return x, y


def warp(field, flow):
    """`field` of the second frame, looked up at the first frame's pixels moved by `flow`."""
    x, y = (place + flow[..., axis] for axis, place in enumerate(pixels_of(flow)))
    x, y = x.astype(np.float32), y.astype(np.float32)
    return cv2.remap(field, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT, borderValue=(1e3, 1e3, 1e3))


def stays_visible(scene, m):
    """Pixels of frame m whose surface is seen at m + 1: the backward flow there brings them back within 0.1 px."""
    back = warp(scene.flow_backward[m], scene.flow_forward[m])
    return np.linalg.norm(scene.flow_forward[m] + back, axis=-1) < 0.1


def static_flow(declared, m, inverse_depth):
    """Flow of a static world from inverse depth and the two cameras, by matrices in the textbook's order."""
    cameras = [camera_at(declared.camera, t, declared.height, declared.width) for t in (m, m + 1)]
    K0, K1 = (np.array([[c.focal, 0, c.center[0]], [0, c.focal, c.center[1]], [0, 0, 1]]) for c in cameras)
    x, y = pixels_of(inverse_depth)
    pixels = np.stack([x, y, np.ones_like(x)], axis=-1)
    seen = pixels @ np.linalg.inv(K0).T / inverse_depth[..., None].astype(np.float64)
    world = seen @ cameras[0].pose.rotation.T + cameras[0].pose.translation
    moved = (world - cameras[1].pose.translation) @ cameras[1].pose.rotation @ K1.T
    return moved[..., :2] / moved[..., 2:] - pixels[..., :2]


@pytest.mark.parametrize("name", SCENES)
def test_tracks_seeded_at_a_pixel_follow_its_flow(name, small):
    scene = small(name)
    start = scene.points[:, 0]
    seeded = scene.visible[:, 0] & (start == np.rint(start)).all(axis=1)
    x, y = start[seeded].astype(int).T
    assert seeded.sum() > 200
    np.testing.assert_allclose(scene.points[seeded, 1] - start[seeded], scene.flow_forward[0, y, x], atol=1e-3)


@pytest.mark.parametrize("name", SCENES)
def test_static_flow_follows_from_inverse_depth_and_cameras(name, small, small_scene):
    scene = small(name)
    for m in (0, 3):
        expected = static_flow(small_scene(name), m, scene.inverse_depth[m])
        static = scene.moving[m] == 0
        np.testing.assert_allclose(scene.flow_forward[m][static], expected[static], atol=1e-4)


@pytest.mark.parametrize("name", SCENES)
def test_forward_and_backward_flow_undo_each_other_where_both_see(name, small):
    scene = small(name)
    for m in range(5):
        assert stays_visible(scene, m).mean() > 0.75


@pytest.mark.parametrize("name", sorted(set(SCENES) - {"nothing-moves", "late-entry", "drive-parked-row"}))
def test_static_flow_does_not_explain_any_mover(name, small, small_scene):
    # 0.25 px of a frame 106 px wide is 1 px of one 426 px wide; the slow mover is named for moving less than that.
    low, high = (0.05, 0.25) if name == "slow-mover" else (0.25, np.inf)
    scene = small(name)
    difference = scene.flow_forward[0] - static_flow(small_scene(name), 0, scene.inverse_depth[0])
    movers = np.unique(scene.moving[0])[1:]
    assert len(movers)
    for identity in movers:
        assert low < np.linalg.norm(difference, axis=-1)[scene.moving[0] == identity].mean() < high


@pytest.mark.parametrize("name", sorted(set(SCENES) - {"brightness-change"}))
def test_next_frame_warped_by_flow_resembles_this_one(name, small):
    scene = small(name)
    for m in (0, 4):
        seen = stays_visible(scene, m)
        now, after = (scene.images[t].astype(np.float32) for t in (m, m + 1))
        error = np.abs(warp(after, scene.flow_forward[m]) - now)[seen].mean()
        assert error < 12.0
        moved = seen & (np.linalg.norm(scene.flow_forward[m], axis=-1) > 0.7)
        if moved.sum() > 200:
            left, right = np.abs(warp(after, scene.flow_forward[m]) - now)[moved], np.abs(after - now)[moved]
            assert left.mean() < 0.7 * right.mean()


@pytest.mark.parametrize("name", SCENES)
def test_flow_is_finite_and_moderate(name, small):
    # Flow scales with the frame: 7 px of a width of 106 px are 28 px of 426. Beside a driving camera it is larger.
    scene = small(name)
    bound = 16.0 if name.startswith("drive-") else 7.0
    for flow in (scene.flow_forward, scene.flow_backward):
        assert np.isfinite(flow).all()
        assert np.linalg.norm(flow, axis=-1).max() < bound
