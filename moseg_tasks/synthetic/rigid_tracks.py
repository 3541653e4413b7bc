"""Exact tracks of rigid objects without images: clusters of points in front of a moving camera."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

IMAGE_SHAPE = (375, 1242)
_FOCAL = 720.0  # px, as of cameras in cars
_CAMERA = (0.1, 0.0, 0.4)
_CAMERA_YAW_DEG = 0.2
_DEPTHS = 14.0, 30.0  # of objects at first
_RADIUS = 1.2  # of an object, in the unit of depth
_SPEED = 0.25  # of a mover, per frame
_TILT = 0.5  # of its path from the vertical, at most about this tangent
_TURN_DEG = 2.0  # of a mover about any axis, per frame


class RigidTracks(NamedTuple):
    """Tracks of objects in several rigid motions.

    Attributes
    ----------
    points : float64 (N, F, 2)
        xy, px.
    visible : bool (N, F)
        Inside the frame; there are no occlusions.
    owner : int64 (N,)
        Object of each track; the order of the objects is random.
    motion : int64 (K,)
        Motion of each object, 0 that of the static scene.
    """

    points: np.ndarray
    visible: np.ndarray
    owner: np.ndarray
    motion: np.ndarray


def rigid_tracks(
    num_objects: Sequence[int], num_frames: int, tracks_per_object: int, noise: float, rng: np.random.Generator
) -> RigidTracks:
    """Return tracks of objects scattered over the frame at different depths, seen by a camera that advances and turns.

    Parameters
    ----------
    num_objects : sequence of int
        Objects of each motion; the first is static. Motions are of objects about their common centre.
    num_frames, tracks_per_object : int
    noise : float
        Standard deviation of each coordinate, px.
    rng : numpy.random.Generator
    """
    motion = rng.permutation(np.repeat(np.arange(len(num_objects)), num_objects))
    owner = np.repeat(np.arange(len(motion)), tracks_per_object)
    height, width = IMAGE_SHAPE
    # Columns of the frame in random order, one for each object.
    x = (rng.permutation(len(motion)) + 0.5) / len(motion) - 0.5
    depth = rng.uniform(*_DEPTHS, len(motion))
    centre = np.stack([0.7 * x * width, rng.uniform(-0.1, 0.1, len(motion)) * height, np.full(len(motion), _FOCAL)], 1)
    world = (centre * (depth / _FOCAL)[:, None])[owner] + rng.uniform(-_RADIUS, _RADIUS, (len(owner), 3))
    points = np.empty((len(owner), num_frames, 2))
    turns = rng.normal(size=(len(num_objects), 3))
    # Up or down, across the epipolar lines of a camera that advances: along them a mover may look static.
    steps = rng.uniform(-_TILT, _TILT, (len(num_objects), 3))
    steps[:, 1] = rng.choice([-1.0, 1.0], len(num_objects))
    for frame in range(num_frames):
        placed = world.copy()
        for index in range(1, len(num_objects)):
            own = motion[owner] == index
            axis, step = (v[index] / np.linalg.norm(v[index]) for v in (turns, steps))
            R = Rotation.from_rotvec(frame * _TURN_DEG * axis, degrees=True).as_matrix()
            middle = world[own].mean(axis=0)
            placed[own] = (world[own] - middle) @ R.T + middle + frame * _SPEED * step
        yaw = Rotation.from_euler("y", frame * _CAMERA_YAW_DEG, degrees=True).as_matrix()
        seen = (placed - frame * np.array(_CAMERA)) @ yaw
        points[:, frame] = _FOCAL * seen[:, :2] / np.maximum(seen[:, 2:], 1.0) + np.array([width - 1, height - 1]) / 2
    points += rng.normal(scale=noise, size=points.shape)
    visible = ((points >= -0.5) & (points <= np.array([width, height]) - 0.5)).all(axis=2)
    return RigidTracks(points, visible, owner, motion)
