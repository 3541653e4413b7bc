"""Exact tracks of a textured wall and of an object, seen by a camera that travels sideways."""

from typing import NamedTuple

import numpy as np
import pytest

from moseg.tasks.geometry.camera_motion import CameraMotion

SHAPE, FOCAL = (120, 200), 160.0
WALL, TRAVEL = 40.0, 1.0
"""Depth of the wall, and travel of the camera in a frame: the wall moves by 4 px."""
LEFT, TOP, SIDE = 90, 40, 40
"""The object in the first frame, px."""


class Passage(NamedTuple):
    """Arguments of `measure_objects`, and the tracks that are the object's."""

    labels: np.ndarray
    points: np.ndarray
    visible: np.ndarray
    pairs: np.ndarray
    cameras: list[CameraMotion]
    strict_test: np.ndarray
    is_object: np.ndarray


@pytest.fixture(scope="session")
def passage():
    """Function that returns a Passage, in which the object moves as a point at depth `depth`; gaps of 2 and 4."""

    def make(depth=WALL, test=0.0, spacing=6.0, num_frames=7, travel=TRAVEL):
        columns, rows = np.meshgrid(np.arange(2, SHAPE[1] - 2, spacing), np.arange(2, SHAPE[0] - 2, spacing))
        start = np.stack([columns, rows], axis=-1).reshape(-1, 2)
        is_object = ((start >= [LEFT, TOP]) & (start < [LEFT + SIDE, TOP + SIDE])).all(axis=1)
        speed = FOCAL * travel / np.where(is_object, depth, WALL)
        points = np.repeat(start[:, None], num_frames, axis=1)
        points[..., 0] -= speed[:, None] * np.arange(num_frames)
        labels = np.zeros((num_frames, *SHAPE), np.uint16)
        for number, frame in enumerate(labels):
            left = round(LEFT - number * FOCAL * travel / depth)
            frame[TOP : TOP + SIDE, max(left, 0) : left + SIDE] = 1
        inside = (points[..., 0] > 0) & (points[..., 0] < SHAPE[1] - 1)
        # The object hides the wall behind it.
        column, row = np.rint(points).astype(int).clip(0, [SHAPE[1] - 1, SHAPE[0] - 1]).transpose(2, 0, 1)
        is_covered = labels[np.arange(num_frames), row, column] == 1
        visible = inside & (is_covered == is_object[:, None])
        pairs = np.array([(first, gap) for gap in (2, 4) for first in range(num_frames - gap)], np.int32)
        camera = CameraMotion(np.eye(3), np.array([-1.0, 0.0, 0.0]), FOCAL)
        strict_test = np.tile(np.where(is_object, test, 0.0).astype(np.float16), (len(pairs), 1))
        return Passage(labels, points.astype(np.float32), visible, pairs, [camera] * len(pairs), strict_test, is_object)

    return make
