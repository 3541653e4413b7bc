"""The camera's motion and focal length from tracks."""

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.focal_length import choose_focal
from moseg.tasks.rigidity.relative_pose import fit_pose

PARAMS = RigidityParams()
SHAPE, FOCAL = (375, 1242), 0.73


def test_the_camera_s_motion_is_recovered_among_movers(see, walls, road, front):
    static, mover = see(np.concatenate([walls, road])), see(front, own=(0.5, 0.0, 0.3))
    points = [np.concatenate(pair) for pair in zip(static[:2], mover[:2], strict=True)]
    motion = fit_pose(*points, FOCAL, SHAPE, PARAMS)
    np.testing.assert_allclose(motion.rotation[0, 2], np.sin(0.01), atol=1e-4)
    np.testing.assert_allclose(motion.translation, [-np.sin(0.01), 0, -np.cos(0.01)], atol=1e-3)
    assert motion.focal == FOCAL * SHAPE[1]


@pytest.mark.parametrize("num_tracks", [0, 1, 5, 15])
def test_few_tracks_show_no_motion(see, walls, num_tracks):
    drive = see(walls)
    assert fit_pose(drive.points0[:num_tracks], drive.points1[:num_tracks], FOCAL, SHAPE, PARAMS) is None


def test_tracks_in_one_place_show_no_motion(see, walls):
    points = np.full((200, 2), 100.0)
    assert fit_pose(points, points + 1, FOCAL, SHAPE, PARAMS) is None


@pytest.mark.parametrize("focal", [0.53, 1.2])
def test_a_camera_that_turns_shows_its_focal_length(see, walls, road, focal):
    drive = see(np.concatenate([walls, road]), yaw=0.12, focal=focal)
    points = np.stack([drive.points0, drive.points1], axis=1).astype(np.float32)
    assert choose_focal(points, np.ones(points.shape[:2], bool), SHAPE, PARAMS) == focal


@pytest.mark.parametrize("num_frames", [1, 2, 3, 9])
def test_without_tracks_the_focal_length_is_the_usual_one(num_frames):
    points, visible = np.zeros((0, num_frames, 2), np.float32), np.zeros((0, num_frames), bool)
    assert choose_focal(points, visible, SHAPE, PARAMS) == 0.73
