import numpy as np
import pytest

from moseg.tasks.rigidity.parallax import find_epipole, split_displacements
from moseg.tasks.saliency.camera import CameraMotion

SHAPE, FOCAL = (375, 1242), 0.73


def motion_of(drive_yaw, advance) -> CameraMotion:
    """Motion X' = R X + t of points, as a camera that advances by `advance` and then turns sees it."""
    cos, sin = np.cos(drive_yaw), np.sin(drive_yaw)
    rotation = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
    return CameraMotion(rotation, -rotation @ advance, FOCAL * SHAPE[1])


@pytest.mark.parametrize("advance", [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 0.0, -1.0), (0.3, 0.1, 0.9)])
def test_static_points_lie_on_their_lines_at_their_inverse_depth(see, walls, advance):
    drive = see(walls, yaw=0.02, advance=np.array(advance))
    parallax = split_displacements(*drive[:2], motion_of(0.02, np.array(advance)), SHAPE)
    np.testing.assert_allclose(parallax.across, 0, atol=1e-9)
    np.testing.assert_allclose(parallax.inverse_depth, 1 / drive.depth, rtol=1e-9)
    np.testing.assert_allclose(parallax.at(1 / drive.depth), parallax.along, rtol=1e-9)


def test_the_parts_lead_from_infinity_to_the_point(see, walls):
    drive = see(walls, own=(0.4, 0.3, 0.2))
    parallax = split_displacements(*drive[:2], motion_of(0.01, np.array([0.0, 0.0, 1.0])), SHAPE)
    aside = np.column_stack([parallax.towards[:, 1], -parallax.towards[:, 0]])
    reached = parallax.rotated + parallax.along[:, None] * parallax.towards + parallax.across[:, None] * aside
    np.testing.assert_allclose(reached, drive.points1, atol=1e-9)


def test_what_recedes_faster_than_the_camera_advances_lies_behind_infinity(see, front):
    drive = see(front, own=(0.0, 0.0, 1.5))
    parallax = split_displacements(*drive[:2], motion_of(0.01, np.array([0.0, 0.0, 1.0])), SHAPE)
    assert (parallax.along < 0).all()


def test_the_epipole_is_where_the_camera_travels_to():
    ahead = find_epipole(motion_of(0.0, np.array([0.0, 0.0, 1.0])), SHAPE)
    np.testing.assert_allclose(ahead, [(SHAPE[1] - 1) / 2, (SHAPE[0] - 1) / 2])
    assert find_epipole(motion_of(0.0, np.array([1.0, 0.0, 0.0])), SHAPE) is None
