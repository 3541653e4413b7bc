"""Deviation along epipolar lines: behind infinity, below the ground, and off the ground."""

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.deviation import deviation_from_ground
from moseg.tasks.rigidity.ground import fit_ground
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import find_epipole, split_displacements
from moseg.tasks.saliency.camera import CameraMotion

PARAMS = RigidityParams()
SHAPE, FOCAL = (375, 1242), 0.73
NEAR = np.array([0.0, 0.0, 9.0])
AHEAD = CameraMotion(np.eye(3), np.array([0.0, 0.0, -1.0]), FOCAL * SHAPE[1])


@pytest.fixture
def deviate(see, road):
    """Function that returns the deviation of a surface's points which move by `own`, with or without a road."""

    def measure(surface, own=(0.0, 0.0, 0.0), has_road=True):
        static, mover = see(road if has_road else road[:0], yaw=0), see(surface, own, yaw=0)
        points0, points1, _ = (np.concatenate(parts) for parts in zip(mover, static, strict=True))
        parallax = split_displacements(points0, points1, AHEAD, SHAPE)
        ground = fit_ground(points0, parallax, find_epipole(AHEAD, SHAPE), SHAPE, PARAMS)
        assert (ground is not None) == has_road
        noise = displacement_noise(points0, points1, PARAMS.noise, PARAMS.noise_share)
        deviation = deviation_from_ground(points0, parallax, ground, SHAPE, noise, PARAMS)
        return deviation, len(mover.points0), parallax.along

    return measure


def test_a_parked_car_deviates_by_little(deviate, front):
    found, _, along = deviate(front)
    np.testing.assert_allclose(found.too_far, 0, atol=0.05)
    # Tracks low on the car may as well lie on the ground, so that its foot seems to be higher than it is.
    assert found.too_near.max() < 0.5
    assert (found.allowed.least <= along).all()


def test_a_car_that_drives_ahead_is_below_the_ground(deviate, front):
    found, num_tracks, _ = deviate(front, own=(0.0, 0.0, 0.7))
    far = (found.too_far / found.far_noise)[:num_tracks]
    low = np.argsort(far)[num_tracks // 2 :]
    assert (far[low] > 1).all()
    assert (found.too_near[:num_tracks][low] == 0).all()


def test_a_car_that_comes_closer_hangs_over_the_ground(deviate, front):
    found, num_tracks, along = deviate(front, own=(0.0, 0.0, -1.0))
    near = found.too_near[:num_tracks]
    assert np.mean(near > 1) > 0.5
    assert (found.too_near[num_tracks:] == 0).all()
    assert (found.allowed.largest[:num_tracks] < along[:num_tracks])[near > 1].all()


def test_where_no_ground_is_seen_below_it_nothing_hangs(deviate, front):
    found, num_tracks, _ = deviate(front - NEAR, own=(0.0, 0.0, -1.0))
    assert (found.too_near[:num_tracks] == 0).all()


def test_what_recedes_faster_than_the_camera_needs_no_ground(deviate, front):
    found, _, _ = deviate(front, own=(0.0, 0.0, 2.5), has_road=False)
    assert (found.too_far > found.far_noise).all()
    assert (found.too_near == 0).all()
    found, _, _ = deviate(front, own=(0.0, 0.0, 0.7), has_road=False)
    assert (found.too_far == 0).all()
