"""Analytic two-view scenes: points in space, seen by two pinhole cameras."""

from typing import NamedTuple

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

IMAGE_SHAPE = (480, 854)
FOCAL = 800.0


class TwoViews(NamedTuple):
    """Matching points float64 (N, 2), px, and the fundamental matrix that produced them (0 without a translation)."""

    points0: np.ndarray
    points1: np.ndarray
    F: np.ndarray


@pytest.fixture
def see():
    """Function that projects points of the first camera's space (N, 3) into both cameras."""
    return _see


@pytest.fixture
def scatter():
    """Function that draws points in the viewing frustum between two depths: float64 (N, 3)."""
    return _scatter


@pytest.fixture
def image_shape():
    return IMAGE_SHAPE


@pytest.fixture(scope="session")
def see_noisy():
    """Function of a seed: 30 matching points with half a pixel of noise, px."""

    def build(seed):
        views = _see(_scatter(30, seed=seed))
        return views.points0, views.points1 + np.random.default_rng(seed).normal(0, 0.5, views.points1.shape)

    return build


def _see(points, translation=(0.3, 0.05, 0.2), rotation_deg=(1.0, -2.0, 0.5)) -> TwoViews:
    height, width = IMAGE_SHAPE
    K = np.array([[FOCAL, 0, (width - 1) / 2], [0, FOCAL, (height - 1) / 2], [0, 0, 1]])
    R = Rotation.from_euler("xyz", rotation_deg, degrees=True).as_matrix()
    t = np.asarray(translation, dtype=np.float64)
    cross = np.array([[0, -t[2], t[1]], [t[2], 0, -t[0]], [-t[1], t[0], 0]])
    F = np.linalg.inv(K).T @ cross @ R @ np.linalg.inv(K)
    homogeneous0, homogeneous1 = points @ K.T, (points @ R.T + t) @ K.T
    return TwoViews(homogeneous0[:, :2] / homogeneous0[:, 2:], homogeneous1[:, :2] / homogeneous1[:, 2:], F)


def _scatter(num_points, seed=0, near=3.0, far=12.0, pixels=((0, 853), (0, 479))) -> np.ndarray:
    rng = np.random.default_rng(seed)
    height, width = IMAGE_SHAPE
    x, y = rng.uniform(*pixels[0], num_points), rng.uniform(*pixels[1], num_points)
    z = rng.uniform(near, far, num_points)
    return np.stack([(x - (width - 1) / 2) * z / FOCAL, (y - (height - 1) / 2) * z / FOCAL, z], axis=1)
