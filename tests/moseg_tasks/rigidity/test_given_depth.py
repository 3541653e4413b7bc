import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.deviation import deviation_from_depth
from moseg.tasks.rigidity.given_depth import bound_inverse_depth
from moseg.tasks.rigidity.parallax import split_displacements

PARAMS = RigidityParams()
SHAPE, FOCAL = (375, 1242), 0.73
CAR = np.s_[180:300, 680:880]


@pytest.fixture
def deviate():
    """Function that returns the deviation of a grid of tracks in front of a wall with a car, from a given map of it."""

    def measure(change=lambda true: true, own=(0.0, 0.0, 0.0), noise=0.1):
        depth = np.full(SHAPE, 25.0) + np.arange(SHAPE[1]) / 100
        depth[CAR] = 12.0
        points0 = np.stack(np.meshgrid(np.arange(10.0, 1230, 15), np.arange(10.0, 370, 15)), axis=-1).reshape(-1, 2)
        column, row = points0.astype(int).T
        z = depth[row, column]
        is_car = z == 12
        focal, centre = FOCAL * SHAPE[1], np.array([(SHAPE[1] - 1) / 2, (SHAPE[0] - 1) / 2])
        world = np.column_stack([(points0 - centre) * z[:, None] / focal, z]) - [0, 0, 1]
        world[is_car] += own
        points1 = focal * world[:, :2] / world[:, 2:] + centre
        points1 = points1 + np.random.default_rng(0).normal(0, noise, points1.shape)
        motion = CameraMotion(np.eye(3), np.array([0.0, 0.0, -1.0]), focal)
        parallax = split_displacements(points0, points1, motion, SHAPE)
        spread = np.full(len(z), 0.5)
        given = change(1 / depth).astype(np.float32)
        bounds = bound_inverse_depth(given, points0, parallax, spread, PARAMS)
        return (None if bounds is None else deviation_from_depth(parallax, bounds, spread, PARAMS)), is_car, parallax

    return measure


@pytest.mark.parametrize("change", [lambda true: true, lambda true: 3e4 * true - 500, lambda true: 1e-9 * true])
def test_what_stands_at_its_given_depth_does_not_deviate(deviate, change):
    found, _, parallax = deviate(change)
    assert (found.too_far / found.far_noise).max() < 1
    assert found.too_near.max() < 1
    assert (found.allowed.least <= parallax.along + 0.5).all()
    assert (found.allowed.largest >= parallax.along - 0.5).all()


def test_a_car_that_drives_ahead_is_farther_than_its_depth_says(deviate):
    found, is_car, _ = deviate(own=(0.0, 0.0, 0.7))
    assert np.median((found.too_far / found.far_noise)[is_car]) > 2
    assert (found.too_far / found.far_noise)[~is_car].max() < 1
    assert found.too_near[is_car].max() == 0


def test_a_car_that_comes_closer_is_nearer_than_its_depth_says(deviate):
    found, is_car, parallax = deviate(own=(0.0, 0.0, -0.8))
    assert np.median(found.too_near[is_car]) > 2
    assert found.too_near[~is_car].max() < 1
    far = is_car & (found.too_near > 2)
    assert (found.allowed.largest < parallax.along)[far].all()


def test_where_depth_is_unknown_any_depth_is_static(deviate):
    def half(true):
        return np.where(np.arange(SHAPE[1]) > 650, np.nan, true)

    found, is_car, parallax = deviate(half, own=(0.0, 0.0, -0.8))
    assert found.too_near[is_car].max() == 0
    assert (found.allowed.largest[is_car] > parallax.along[is_car]).all()
    assert np.isfinite(found.too_far).all()


@pytest.mark.parametrize(
    "change", [lambda true: -true, lambda true: 0 * true, lambda true: np.nan * true, lambda true: np.inf * true]
)
def test_depth_that_does_not_explain_the_parallax_is_not_used(deviate, change):
    assert deviate(change)[0] is None


def test_without_tracks_depth_is_not_used():
    nothing = np.zeros((0, 2))
    motion = CameraMotion(np.eye(3), np.array([0.0, 0.0, -1.0]), FOCAL * SHAPE[1])
    parallax = split_displacements(nothing, nothing, motion, SHAPE)
    assert bound_inverse_depth(np.ones(SHAPE, np.float32), nothing, parallax, nothing[:, 0], PARAMS) is None
