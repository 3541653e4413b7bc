"""Points that follow a motion model exactly, in images of a KITTI camera."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from moseg.tasks.motion_models import FLOW_MODELS
from moseg.tasks.point_models import Correspondences

WIDTH, HEIGHT, FOCAL = 1242, 375, 720.0
CENTRE = ((WIDTH - 1) / 2, (HEIGHT - 1) / 2)
CENTRES = ((0.4, 0.05, 0.6), (0.5, -0.4, 1.3))
ROTATIONS_DEG = ((1.0, -2.0, 0.5), (-1.0, 3.0, 1.0))


@pytest.fixture(scope="session")
def follow():
    """Function of points in space (N, 3), camera centres and rotations after the first frame: points (N, F, 2), px."""
    return _follow


@pytest.fixture(scope="session")
def scatter():
    """Function of a count and a seed: points (N, 3) seen by the first camera, 6 to 40 m away."""
    return _scatter


@pytest.fixture(scope="session")
def obey():
    """Function of a model's name, a count and a seed: correspondences without noise."""
    return lambda name, num_points=60, seed=0: _SCENES[name](num_points, np.random.default_rng(seed))


@pytest.fixture(scope="session")
def noisy():
    """Function that adds Gaussian noise of a standard deviation, px, to correspondences."""

    def add(data, sigma, seed=9):
        noise = np.random.default_rng(seed).normal(0, sigma, data.points.shape)
        return data._replace(points=data.points + noise)

    return add


def _follow(points, centres=CENTRES, rotations_deg=ROTATIONS_DEG):
    K = np.array([[FOCAL, 0, CENTRE[0]], [0, FOCAL, CENTRE[1]], [0, 0, 1]])
    frames = []
    for centre, angles in zip(((0, 0, 0), *centres), ((0, 0, 0), *rotations_deg), strict=True):
        R = Rotation.from_euler("xyz", angles, degrees=True).as_matrix()
        seen = (points - np.asarray(centre, dtype=np.float64)) @ R.T @ K.T
        frames.append(seen[:, :2] / seen[:, 2:])
    return np.stack(frames, axis=1)


def _scatter(num_points, seed=0):
    rng = np.random.default_rng(seed)
    z = rng.uniform(6, 40, num_points)
    pixels = _pixels(num_points, rng) - CENTRE
    return np.concatenate([pixels * z[:, None] / FOCAL, z[:, None]], axis=1)


def _pixels(num_points, rng):
    return rng.uniform(0, 1, (num_points, 2)) * [WIDTH - 1, HEIGHT - 1]


def _affine(num_points, rng):
    points0 = _pixels(num_points, rng)
    linear = np.eye(2) + rng.normal(0, 0.05, (2, 2))
    return Correspondences(np.stack([points0, points0 @ linear.T + rng.normal(0, 20, 2)], axis=1))


def _homography(num_points, rng):
    points0 = _pixels(num_points, rng)
    H = np.eye(3) + rng.normal(0, 1, (3, 3)) * [[0.05, 0.05, 20], [0.05, 0.05, 20], [5e-5, 5e-5, 0]]
    points1 = np.concatenate([points0, np.ones((num_points, 1))], axis=1) @ H.T
    return Correspondences(np.stack([points0, points1[:, :2] / points1[:, 2:]], axis=1))


def _fundamental(num_points, rng):
    return Correspondences(_follow(_scatter(num_points, int(rng.integers(2**31))), CENTRES[:1], ROTATIONS_DEG[:1]))


def _trifocal(num_points, rng):
    return Correspondences(_follow(_scatter(num_points, int(rng.integers(2**31)))))


def _flow(name):
    def scene(num_points, rng):
        model = FLOW_MODELS[name]
        points0, depth = _pixels(num_points, rng), rng.uniform(0.1, 1, num_points)
        x, y = ((points0 - CENTRE) / (WIDTH / 2)).T
        flow = model.design(x, y, depth) @ rng.normal(0, 10, model.num_parameters)
        return Correspondences(np.stack([points0, points0 + flow], axis=1), depth, CENTRE)

    return scene


_SCENES = {
    "affine": _affine,
    "homography": _homography,
    "fundamental": _fundamental,
    "bilinear": _fundamental,
    "trifocal": _trifocal,
    "oc": _flow("oc"),
    "oc_depth": _flow("oc_depth"),
}
