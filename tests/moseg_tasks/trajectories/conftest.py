"""A clip of exact trajectories: rigid groups of points in space before a moving camera."""

from typing import NamedTuple

import numpy as np
import pytest


class RigidClip(NamedTuple):
    points: np.ndarray
    visible: np.ndarray
    labels: np.ndarray


def rigid_clip(sizes=(60, 30), num_frames=8, noise=0.05, hidden=0.1, seed=0) -> RigidClip:
    """Group 0 stands still before a camera that drives forward and to the side; each other has a motion of its own."""
    rng = np.random.default_rng(seed)
    steps = rng.uniform(-0.25, 0.25, (len(sizes), 3))
    steps[0] = 0
    turns = rng.uniform(-0.03, 0.03, len(sizes)) * (np.arange(len(sizes)) > 0)
    centres = np.array([[0, 0, 16], [-4, 1, 10], [4, -1, 10], [0, 2, 8]], dtype=float)
    extents = np.array([[9, 4, 6], [1.5, 1.2, 1.5], [1.5, 1.2, 1.5], [1, 1, 1]], dtype=float)
    tracks = []
    for group, size in enumerate(sizes):
        body = rng.uniform(-1, 1, (size, 3)) * extents[group]
        frames = []
        for frame in range(num_frames):
            angle = turns[group] * frame
            turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
            world = body @ turn.T + centres[group] + steps[group] * frame
            camera = world - np.array([0.12, 0.02, 0.3]) * frame
            frames.append(400 * camera[:, :2] / camera[:, 2:] + [300, 200])
        tracks.append(np.stack(frames, axis=1))
    points = np.concatenate(tracks)
    visible = rng.random(points.shape[:2]) >= hidden
    return RigidClip(points + rng.normal(0, noise, points.shape), visible, np.repeat(np.arange(len(sizes)), sizes))


@pytest.fixture(name="rigid_clip", scope="session")
def _rigid_clip():
    """The function that makes clips."""
    return rigid_clip
