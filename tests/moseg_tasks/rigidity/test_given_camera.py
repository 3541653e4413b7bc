"""A given camera and its focal length, corrected by tracks, in exact drives."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.given_camera import correct_camera
from moseg.tasks.rigidity.given_depth import scale_inverse_depth
from moseg.tasks.rigidity.given_focal import correct_focal
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.rigidity.relative_pose import fit_pose

PARAMS = RigidityParams()
AS_GIVEN = RigidityParams(camera_slip=0, camera_share=0)
SHAPE, FOCAL = (375, 1242), 0.73
YAW = 0.01
TURN = Rotation.from_rotvec([0, YAW, 0]).as_matrix()
POSE = np.column_stack([TURN, TURN @ [0, 0, -1]])


def depth_map(*drives):
    """Return the inverse depth of tracks of drives, NaN between them."""
    found = np.full(SHAPE, np.nan, np.float32)
    for drive in drives:
        column, row = np.rint(drive.points0).astype(int).T
        found[row, column] = 1 / drive.depth
    return found


def joined(*drives):
    return tuple(np.concatenate(points) for points in zip(*(drive[:2] for drive in drives), strict=True))


def disturbed(pose, degrees=0.4, factor=1.0):
    """Return a pose with another rotation, and another length and direction of its translation."""
    turn = Rotation.from_rotvec(np.radians(degrees) * np.array([0.6, -0.6, 0.5])).as_matrix()
    return np.column_stack([turn @ pose[:, :3], factor * turn @ turn @ pose[:, 3]])


def angle(rotation):
    return np.degrees(np.linalg.norm(Rotation.from_matrix(rotation).as_rotvec()))


@pytest.fixture
def street(see, walls, road):
    return see(np.concatenate([walls, road]), yaw=YAW)


def test_an_exact_camera_stays(street):
    found = correct_camera(POSE, depth_map(street), *street[:2], FOCAL, PARAMS)
    np.testing.assert_allclose(found.motion.rotation, TURN, atol=1e-6)
    np.testing.assert_allclose(found.motion.translation, POSE[:, 3], atol=1e-5)
    assert found.length == pytest.approx(1, abs=1e-4) and found.cost < 1e-4


@pytest.mark.parametrize("factor", [0.8, 1.0, 1.3])
def test_a_disturbed_camera_is_corrected_with_the_length_of_its_translation(street, factor):
    given = disturbed(POSE, factor=factor)
    before = correct_camera(given, depth_map(street), *street[:2], FOCAL, AS_GIVEN)
    found = correct_camera(given, depth_map(street), *street[:2], FOCAL, PARAMS)
    assert angle(before.motion.rotation.T @ TURN) == pytest.approx(0.4, abs=0.01) and before.cost > 0.8
    assert angle(found.motion.rotation.T @ TURN) < 0.002
    assert found.length == pytest.approx(1, abs=2e-3)


def test_a_given_camera_is_not_drawn_to_a_mover_that_owns_most_of_the_tracks(see, walls):
    """A bus that fills the middle, and only parts of house fronts around it."""
    rng = np.random.default_rng(3)
    bus = np.column_stack([rng.uniform(-5, 5, 1500), rng.uniform(-2.4, 1.5, 1500), rng.uniform(9, 12, 1500)])
    static, mover = see(walls, yaw=YAW), see(bus, own=(0.35, 0.0, 0.8), yaw=YAW)
    points = joined(static, mover)
    on_tracks = fit_pose(*points, FOCAL, SHAPE, PARAMS)
    given = disturbed(POSE, degrees=0.1)
    found = correct_camera(given, depth_map(static, mover), *points, FOCAL, PARAMS)
    assert len(mover.points0) > 2 * len(static.points0)
    assert on_tracks.translation @ POSE[:, 3] < 0.7
    assert found.motion.translation @ POSE[:, 3] > 0.99


def test_a_camera_that_only_turns_moves_no_track_whatever_its_depth(see, walls, road):
    drive = see(np.concatenate([walls, road]), yaw=YAW, advance=np.zeros(3))
    turned = np.column_stack([TURN, np.zeros(3)])
    for pose in (turned, disturbed(turned)):
        found = correct_camera(pose, depth_map(drive), *drive[:2], FOCAL, PARAMS)
        assert angle(found.motion.rotation.T @ TURN) < 0.01
        assert found.length < 0.01 and np.linalg.norm(found.motion.translation) == pytest.approx(1)


def test_a_camera_that_explains_few_tracks_is_not_used(street):
    wrong = np.column_stack([np.eye(3), [3.0, 2.0, 0.0]])
    assert (
        correct_camera(wrong, depth_map(street), *street[:2], FOCAL, PARAMS.model_copy(update={"camera_slip": 0}))
        is None
    )
    assert correct_camera(wrong, depth_map(street), *street[:2], FOCAL, AS_GIVEN).cost > 0.9


@pytest.mark.parametrize("num_tracks", [0, 1, 15])
def test_few_tracks_correct_no_camera(street, num_tracks):
    points = (each[:num_tracks] for each in street[:2])
    assert correct_camera(POSE, depth_map(street), *points, FOCAL, PARAMS) is None


def test_tracks_without_depth_correct_no_camera(street):
    assert correct_camera(POSE, np.full(SHAPE, np.nan, np.float32), *street[:2], FOCAL, PARAMS) is None


@pytest.mark.parametrize("factor", [0.87, 1.0, 1.2])
def test_the_focal_length_is_corrected_where_the_camera_turns(see, walls, road, factor):
    drive = see(np.concatenate([walls, road]), yaw=0.12)
    turn = Rotation.from_rotvec([0, 0.12, 0]).as_matrix()
    poses = {(0, 2): np.column_stack([turn, turn @ [0, 0, -1]])}
    points = np.stack([drive.points0, drive.points0, drive.points1], axis=1)
    visible = np.ones(points.shape[:2], bool)
    found = correct_focal(factor * FOCAL, poses, [depth_map(drive)].__getitem__, points, visible, PARAMS)
    assert found == pytest.approx(FOCAL, rel=0.05)


def test_without_an_explanation_there_is_no_focal_length(street):
    points = np.stack([*street[:2]], axis=1)
    nothing = np.full(SHAPE, np.nan, np.float32)
    visible = np.ones(points.shape[:2], bool)
    assert correct_focal(FOCAL, {(0, 1): POSE}, [nothing].__getitem__, points, visible, PARAMS) is None
    assert correct_focal(FOCAL, {}, [nothing].__getitem__, points, visible, PARAMS) is None


@pytest.fixture
def bounds(street):
    """Function that returns the bounds of depth that is wrong by a factor, and the measured parallax."""
    parallax = split_displacements(*street[:2], CameraMotion(TURN, POSE[:, 3], FOCAL * SHAPE[1]), SHAPE)

    def measure(factor, length=1.0):
        noise = np.full(len(street.points0), 0.5)
        given = (factor * depth_map(street)).astype(np.float32)
        return scale_inverse_depth(given, length, street.points0, parallax, noise, PARAMS), parallax

    return measure


@pytest.mark.parametrize(("factor", "length"), [(1.0, 1.0), (1e-6, 1e6), (40.0, 0.025), (0.8, 1.0), (1.3, 1.0)])
def test_depth_in_the_unit_of_the_camera_bounds_the_parallax_of_tracks(bounds, factor, length):
    found, parallax = bounds(factor, length)
    assert (parallax.at(found.farthest) <= parallax.along * 1.1 + 0.1).all()
    assert (parallax.at(found.nearest) >= parallax.along * 0.9 - 0.1).all()


@pytest.mark.parametrize("factor", [0.0, 0.3, 4.0])
def test_depth_in_another_unit_than_the_camera_is_not_used(bounds, factor):
    assert bounds(factor)[0] is None
