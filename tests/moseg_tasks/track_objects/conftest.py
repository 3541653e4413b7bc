"""Fixtures: a grid of static tracks, blocks of tracks that move differently, and the evidence about them."""

from typing import NamedTuple

import numpy as np
import pytest

from moseg.tasks.track_objects import PairEvidence

NUM_FRAMES = 8


class Drive(NamedTuple):
    """Tracks (track, frame, xy), their visibility, the true object of each, and their evidence over frame pairs."""

    points: np.ndarray
    visible: np.ndarray
    truth: np.ndarray
    evidence: PairEvidence


@pytest.fixture(scope="session")
def drive():
    """Return a function that makes a scene of blocks, each given by corner, side in tracks, motion and test."""

    def make(*blocks, num_frames=NUM_FRAMES, spacing=10.0):
        rows, columns = np.mgrid[0:20, 0:30].reshape(2, -1)
        starts = np.stack([columns, rows], axis=1) * spacing
        truth = np.zeros(len(starts), int)
        motion, error, test = np.full((len(starts), 2), (1.0, 0.0)), np.full(len(starts), 0.4), np.zeros(len(starts))
        for label, (corner, side, step, tested) in enumerate(blocks, start=1):
            inside = ((starts >= corner) & (starts < np.add(corner, side * spacing))).all(axis=1)
            truth[inside], motion[inside], error[inside], test[inside] = label, step, 4.0, tested
        points = (starts[:, None] + motion[:, None] * np.arange(num_frames)[:, None]).astype(np.float32)
        visible = np.ones((len(starts), num_frames), bool)
        num_pairs = max(num_frames - 2, 0)
        arrays = (np.tile(values, (num_pairs, 1)).astype(np.float16) for values in (error, error, test, error, test))
        return Drive(points, visible, truth, PairEvidence(*arrays))

    return make
