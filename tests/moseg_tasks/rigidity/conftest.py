"""Exact drives: points of a street, seen by a camera that advances over its ground."""

from typing import NamedTuple

import numpy as np
import pytest

SHAPE = (375, 1242)
FOCAL = 0.73
CAMERA_HEIGHT = 1.5
ADVANCE = np.array([0.0, 0.0, 1.0])


class Drive(NamedTuple):
    """Tracks of a pair; `depth` is that in frame 0, in the unit of the camera's height."""

    points0: np.ndarray
    points1: np.ndarray
    depth: np.ndarray


def turned(yaw: float) -> np.ndarray:
    """Return the rotation about the vertical by an angle, rad."""
    cos, sin = np.cos(yaw), np.sin(yaw)
    return np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])


def pitched(pitch: float) -> np.ndarray:
    """Return the rotation about the horizontal by an angle, rad."""
    cos, sin = np.cos(pitch), np.sin(pitch)
    return np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])


def project(world: np.ndarray, focal: float = FOCAL) -> np.ndarray:
    """Return the pixels xy (N, 2) of points (N, 3) of the camera's coordinates."""
    height, width = SHAPE
    return focal * width * world[:, :2] / world[:, 2:] + [(width - 1) / 2, (height - 1) / 2]


@pytest.fixture(scope="session")
def see():
    """Function that returns the Drive of points (N, 3), of which each moves by `own` while the camera advances."""

    def build(world, own=(0.0, 0.0, 0.0), yaw=0.01, advance=ADVANCE, focal=FOCAL, pitch=0.0):
        moved = (world + own - advance) @ turned(yaw).T @ pitched(pitch).T
        drive = Drive(project(world, focal), project(moved, focal), world[:, 2])
        seen = np.all([(p >= 4) & (p <= np.array(SHAPE[::-1]) - 5) for p in drive[:2]], axis=(0, 2))
        return Drive(*(part[seen] for part in drive))

    return build


@pytest.fixture(scope="session")
def road():
    """Points of the ground: x right, y down, z ahead."""
    rng = np.random.default_rng(0)
    depth = 1 / rng.uniform(1 / 40, 1 / 5, 1500)
    return np.column_stack([rng.uniform(-9, 9, 1500), np.full(1500, CAMERA_HEIGHT), depth])


@pytest.fixture(scope="session")
def walls():
    """Points of house fronts at both sides, above the ground."""
    rng = np.random.default_rng(1)
    side = rng.choice([-9.0, 9.0], 800)
    return np.column_stack([side, rng.uniform(-4, CAMERA_HEIGHT, 800), rng.uniform(8, 50, 800)])


@pytest.fixture(scope="session")
def front():
    """Points of an upright surface on the ground, 14 ahead: the front of a car."""
    rng = np.random.default_rng(2)
    return np.column_stack([rng.uniform(1, 3, 150), rng.uniform(0, CAMERA_HEIGHT, 150), np.full(150, 14.0)])


@pytest.fixture(scope="session")
def wander():
    """Function that returns six frames of noise, and tracks of a grid that move in one of several ways."""

    def build(motion):
        rng = np.random.default_rng(0)
        frames = rng.integers(0, 256, (6, 96, 128, 3), dtype=np.uint8)
        start = np.stack(np.meshgrid(np.arange(4.0, 124, 6), np.arange(4.0, 92, 6)), axis=-1).reshape(-1, 1, 2)
        steps = {
            "none": np.zeros((1, 6, 2)),
            "pan": np.arange(6)[None, :, None] * [1.5, 0.0],
            "random": rng.normal(0, 5, (len(start), 6, 2)),
            "grid": np.arange(6)[None, :, None] * np.sign(start - [64, 48]),
        }
        points = np.clip(start + steps[motion], 0, [127, 95]).astype(np.float32)
        return frames, points, np.ones(points.shape[:2], bool)

    return build
