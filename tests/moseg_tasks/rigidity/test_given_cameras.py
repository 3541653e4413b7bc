"""Rendered scenes with their exact cameras and depth: what moves deviates, and what stands does not, however far."""

from functools import cache

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from moseg.schemas.parameters import DenseTrackParams, RigidityParams
from moseg.tasks.dense_tracks import track_densely
from moseg.tasks.rigidity import TRACK_EVIDENCE, GivenCameras, estimate_rigidity
from moseg.tasks.synthetic import SCENES, STILL_SCENES, camera_at, render_scene

PARAMS = RigidityParams()
NUM_FRAMES = 6
MOVERS = ("forward-drive-epipolar-car", "pure-rotation", "static-camera")
STILL = ("rendered-street", "rendered-wall", "nothing-moves")


@cache
def seen(name):
    """Return a scene, its rendering and its tracks."""
    scene = (SCENES | STILL_SCENES)[name].model_copy(update={"num_frames": NUM_FRAMES})
    rendered = render_scene(scene)
    flows = zip(rendered.flow_forward, rendered.flow_backward, strict=True)
    return scene, rendered, track_densely(rendered.images, flows, DenseTrackParams())


def cameras_of(scene, degrees=0.0, factor=1.0):
    """Return the exact cameras of a scene, or cameras with other rotations and another focal length."""
    cameras = [camera_at(scene.camera, time, scene.height, scene.width) for time in range(NUM_FRAMES)]
    rng, poses = np.random.default_rng(0), {}
    for gap in PARAMS.gaps:
        for start in range(NUM_FRAMES - gap):
            first, second = cameras[start].pose, cameras[start + gap].pose
            slip = Rotation.from_rotvec(np.radians(degrees) * rng.normal(size=3) / 3**0.5).as_matrix()
            shift = second.rotation.T @ (first.translation - second.translation)
            poses[start, gap] = np.column_stack([slip @ second.rotation.T @ first.rotation, factor * shift])
    return GivenCameras(poses, factor * cameras[0].focal / max(scene.height, scene.width))


def evidence(name, cameras=None, depth=1.0, params=PARAMS):
    """Return the errors of tracks of static and of moving surfaces, over all pairs."""
    _, rendered, tracks = seen(name)
    inverse_depth = (depth * rendered.inverse_depth).astype(np.float32)
    found = estimate_rigidity(rendered.images, *tracks, params, inverse_depth.__getitem__, cameras=cameras)
    static, moving = [], []
    for (start, gap), error in zip(found.pairs, found.error, strict=True):
        index = np.flatnonzero(np.isfinite(error))
        (x0, y0), (x1, y1) = (tracks.points[index, t].round().astype(int).T for t in (start, start + gap))
        stays = rendered.objects[start][y0, x0] == rendered.objects[start + gap][y1, x1]
        moves = rendered.moving[start][y0, x0] > 0
        static.append(error[index][stays & ~moves])
        moving.append(error[index][stays & moves])
    return np.concatenate(static), np.concatenate(moving)


@pytest.mark.parametrize("name", MOVERS)
@pytest.mark.parametrize(("degrees", "factor"), [(0.0, 1.0), (0.3, 1.1)], ids=["exact", "disturbed"])
def test_movers_deviate_from_given_cameras_and_static_surfaces_do_not(name, degrees, factor):
    static, moving = evidence(name, cameras_of(seen(name)[0], degrees, factor))
    assert np.mean(moving > 1) > 0.9
    assert np.mean(static > 1) < 0.03


@pytest.mark.parametrize("name", STILL)
@pytest.mark.parametrize("degrees", [0.0, 0.3], ids=["exact", "disturbed"])
def test_parallax_is_no_evidence(name, degrees):
    static, moving = evidence(name, cameras_of(seen(name)[0], degrees))
    assert len(moving) == 0
    assert np.mean(static > 1) < 0.05


@pytest.mark.parametrize("name", ["pure-rotation", "static-camera"])
def test_without_parallax_only_given_cameras_show_what_moves_along_the_lines_of_some_camera(name):
    _, fitted = evidence(name)
    _, given = evidence(name, cameras_of(seen(name)[0]))
    assert np.mean(fitted > 1) < 0.6 and np.mean(given > 1) > 0.9


def test_cameras_that_tracks_do_not_correct_move_the_whole_scene():
    given = cameras_of(seen("rendered-street")[0], degrees=0.3)
    static, _ = evidence(
        "rendered-street", given, params=PARAMS.model_copy(update={"camera_slip": 0, "camera_share": 0})
    )
    assert np.mean(static > 1) > 0.5


def test_the_unit_of_cameras_and_depth_does_not_matter():
    scene = seen("forward-drive-epipolar-car")[0]
    exact = cameras_of(scene)
    large = GivenCameras({pair: pose * [1, 1, 1, 1000] for pair, pose in exact.poses.items()}, exact.focal)
    for first, second in zip(evidence(MOVERS[0], exact), evidence(MOVERS[0], large, depth=1e-3), strict=True):
        np.testing.assert_allclose(first, second, atol=0.02)


def test_cameras_of_another_scene_are_replaced_by_a_fit_to_tracks():
    exact = cameras_of(seen("rendered-street")[0])
    wrong = {pair: np.column_stack([np.eye(3), [5.0, -3.0, 0.0]]) for pair in exact.poses}
    params = PARAMS.model_copy(update={"camera_slip": 0})
    fitted, given = (evidence("rendered-street", each, params=params)[0] for each in (None, GivenCameras(wrong, 0.95)))
    np.testing.assert_array_equal(fitted, given)


@pytest.mark.parametrize("motion", ["none", "pan", "random", "grid"])
@pytest.mark.parametrize("shift", [0.0, 1e-6, 1.0, 1e6])
def test_tracks_of_any_motion_give_finite_evidence_with_any_cameras(wander, motion, shift):
    rng, tracks = np.random.default_rng(0), wander(motion)
    pairs = [(first, gap) for gap in PARAMS.gaps for first in range(6 - gap)]
    poses = {
        pair: np.column_stack([Rotation.random(random_state=index).as_matrix(), shift * rng.normal(size=3)])
        for index, pair in enumerate(pairs)
    }
    depth = np.exp(rng.normal(size=(6, 96, 128))).astype(np.float32)
    for params in (PARAMS, PARAMS.model_copy(update={"camera_share": 0.0})):
        given = GivenCameras(poses, 0.7)
        found = estimate_rigidity(*tracks, params, depth.__getitem__, cameras=given)
        assert len(found.pairs) == len(pairs)
        assert all(np.isfinite(getattr(found, name)).all() for name in TRACK_EVIDENCE)
