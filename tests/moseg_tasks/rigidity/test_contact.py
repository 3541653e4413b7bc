"""Height of a surface's bottom above the ground: what comes closer hangs, what the noise hides does not count."""

import numpy as np
import pytest

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.rigidity.contact import _surfaces, contact_excess
from moseg.tasks.rigidity.ground import Ground
from moseg.tasks.rigidity.parallax import find_epipole, split_displacements
from moseg.tasks.saliency.camera import CameraMotion

PARAMS = RigidityParams()
SHAPE, FOCAL, CAMERA_HEIGHT = (375, 1242), 0.73, 1.5
AHEAD = CameraMotion(np.eye(3), np.array([0.0, 0.0, -1.0]), FOCAL * SHAPE[1])
GROUND = Ground(np.array([0.0, 1 / (CAMERA_HEIGHT * FOCAL * SHAPE[1])]), find_epipole(AHEAD, SHAPE))
ADVANCE = np.array([0.0, 0.0, 1.0])
PARKED, COMING = (0.0, 0.0, 0.0), (0.0, 0.0, -1.0)


@pytest.fixture
def measure(see, road, front):
    """Function that returns excess and height of a car's front that moves by `own`, at a noise of all tracks, px."""

    def call(own, noise, **changes):
        static, mover = see(road, yaw=0), see(front, own, yaw=0)
        points0, points1, _ = (np.concatenate(parts) for parts in zip(mover, static, strict=True))
        parallax = split_displacements(points0, points1, AHEAD, SHAPE)
        params = PARAMS.model_copy(update=changes)
        excess, height = contact_excess(points0, parallax, GROUND, SHAPE, np.full(len(points0), noise), params)
        np.testing.assert_array_equal(excess > 0, height > 0)
        num_tracks = len(mover.points0)
        assert not excess[num_tracks:].any()
        return excess[:num_tracks], height[:num_tracks]

    return call


def trunk() -> np.ndarray:
    """Return points (N, 3) of a trunk beside the road, 14 ahead, whose foot is not seen."""
    rng = np.random.default_rng(3)
    return np.column_stack([rng.uniform(2.9, 3.2, 80), rng.uniform(-1, 0.75, 80), np.full(80, 14.0)])


def bank(num_points: int, height: float) -> np.ndarray:
    """Return points (N, 3) of a terrace behind it, a height above the road."""
    rng = np.random.default_rng(4)
    x, z = rng.uniform(3, 4.5, num_points), rng.uniform(17.5, 21, num_points)
    return np.column_stack([x, np.full(num_points, CAMERA_HEIGHT - height), z])


@pytest.mark.parametrize(
    ("num_points", "height", "hangs"),
    [(0, 0.35, True), (5, 0.35, True), (22, 0.35, False), (150, 0.35, False), (150, 0.05, True)],
)
def test_a_trunk_on_ground_that_rises_does_not_hang(see, road, num_points, height, hangs):
    scene = see(np.concatenate([trunk(), bank(num_points, height), road]), yaw=0)
    parallax = split_displacements(scene.points0, scene.points1, AHEAD, SHAPE)
    excess, _ = contact_excess(scene.points0, parallax, GROUND, SHAPE, np.full(len(scene.points0), 0.2), PARAMS)
    assert excess[scene.depth == 14.0].any() == hangs


@pytest.mark.parametrize(("frame_height", "hangs"), [(375, False), (385, False), (395, True)])
def test_a_foot_that_the_frame_cuts_off_does_not_hang(see, road, frame_height, hangs):
    # A car 6 ahead whose tracks end at row 353; the camera's height is 227 px there.
    rng = np.random.default_rng(5)
    car = np.column_stack([rng.uniform(1, 2.5, 900), rng.uniform(0, 1.1, 900), np.full(900, 6.0)])
    column = road[:, 0] / road[:, 2]
    beside = road[(column < 1 / 6) | (column > 2.5 / 6)]
    scene = see(np.concatenate([car, beside]), yaw=0, advance=0.1 * ADVANCE)
    parallax = split_displacements(scene.points0, scene.points1, AHEAD, SHAPE)
    # In lengths of the camera's way.
    ground = GROUND._replace(slope=0.1 * GROUND.slope)
    noise = np.full(len(scene.points0), 0.05)
    excess, _ = contact_excess(scene.points0, parallax, ground, (frame_height, SHAPE[1]), noise, PARAMS)
    assert excess[scene.depth == 6.0].any() == hangs


@pytest.mark.parametrize("noise", [0.1, 0.5, 1.0, 1.5])
def test_a_parked_car_does_not_hang_however_much_of_its_foot_the_noise_hides(measure, noise):
    assert not measure(PARKED, noise)[0].any()


def test_without_a_margin_a_parked_car_seems_to_hang(measure):
    # Its lowest track above what the noise hides lies a little higher than that.
    assert measure(PARKED, 1.0, contact_margin=0.0)[0].any()


@pytest.mark.parametrize("noise", [0.1, 0.5, 1.0])
def test_a_car_that_comes_closer_hangs(measure, noise):
    excess, height = measure(COMING, noise)
    assert np.mean(excess > 1) > 0.7
    # It moves as a point that is half as far away.
    assert height[excess > 0].min() == pytest.approx(0.5, abs=0.05)


def test_only_a_lift_beyond_the_margin_counts(measure):
    # At this noise an eighth of a camera height above the contact is hidden.
    assert measure(COMING, 0.1, contact_margin=0.3)[0].any()
    assert not measure(COMING, 0.1, contact_margin=0.45)[0].any()


def test_surfaces_do_not_depend_on_the_order_of_the_tracks():
    points = np.column_stack([np.arange(4) * 3.0, np.full(4, 100.0)])
    depth, noise = np.array([1.0, 1.3, 1.3, 1.3]), np.array([0.3, 0.0, 0.0, 0.0])
    forward = _surfaces(points, depth, noise, RigidityParams())
    backward = _surfaces(points[::-1], depth[::-1], noise[::-1], RigidityParams())[::-1]
    np.testing.assert_array_equal(forward >= 0, backward >= 0)
