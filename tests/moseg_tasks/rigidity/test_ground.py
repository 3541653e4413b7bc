import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.ground import fit_ground
from moseg.tasks.rigidity.parallax import find_epipole, split_displacements
from moseg.tasks.saliency.camera import CameraMotion

PARAMS = RigidityParams()
SHAPE, FOCAL, CAMERA_HEIGHT = (375, 1242), 0.73, 1.5
AHEAD = CameraMotion(np.eye(3), np.array([0.0, 0.0, -1.0]), FOCAL * SHAPE[1])


def ground_of(drive, motion=AHEAD):
    parallax = split_displacements(*drive[:2], motion, SHAPE)
    return fit_ground(drive.points0, parallax, find_epipole(motion, SHAPE), SHAPE, PARAMS)


def test_the_ground_under_houses_is_recovered(see, road, walls):
    ground = ground_of(see(np.concatenate([road, walls]), yaw=0))
    points = see(road, yaw=0)
    np.testing.assert_allclose(ground.inverse_depth(points.points0), 1 / points.depth, rtol=1e-3)
    assert ground.inverse_depth(np.array([[600.0, 100.0]])) < 0


@pytest.mark.parametrize("pitch", [-0.02, 0.02])
def test_a_camera_that_nods_sees_the_same_ground(see, road, walls, pitch):
    cos, sin = np.cos(pitch), np.sin(pitch)
    rotation = np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
    motion = AHEAD._replace(rotation=rotation, translation=rotation @ AHEAD.translation)
    ground = ground_of(see(np.concatenate([road, walls]), yaw=0, pitch=pitch), motion)
    points = see(road, yaw=0, pitch=pitch)
    np.testing.assert_allclose(ground.inverse_depth(points.points0), 1 / points.depth, rtol=1e-3)


def test_noise_does_not_bend_the_ground(see, road, walls):
    drive = see(np.concatenate([road, walls]), yaw=0)
    noisy = drive._replace(points1=drive.points1 + np.random.default_rng(0).normal(0, 0.3, drive.points1.shape))
    assert ground_of(noisy).slope[1] == pytest.approx(1 / (CAMERA_HEIGHT * FOCAL * SHAPE[1]), rel=0.03)


def test_few_tracks_show_no_ground(see, road):
    drive = see(road[:15], yaw=0)
    assert ground_of(drive) is None
    assert ground_of(type(drive)(*(part[:0] for part in drive))) is None


def test_a_wall_ahead_is_no_ground(see, front):
    wall = front * [4.0, 3.0, 1.0] - [6.0, 0.5, 0.0]
    assert ground_of(see(wall, yaw=0)) is None


def test_a_camera_that_travels_sideways_shows_no_ground(see, road):
    motion = AHEAD._replace(translation=np.array([-1.0, 0.0, 0.0]))
    assert ground_of(see(road, yaw=0, advance=np.array([1.0, 0.0, 0.0])), motion) is None
