"""Paths of points along the flow of a window of frames."""

from collections.abc import Sequence
from typing import NamedTuple

import cv2
import numpy as np


class Paths(NamedTuple):
    """Paths of N points through T frames.

    Attributes
    ----------
    points : float32 (N, T, 2)
        xy, px; where a point is lost its last place.
    visible : bool (N, T)
        One run of frames around the one it starts in.
    """

    points: np.ndarray
    visible: np.ndarray


def follow_points(flows: Sequence[np.ndarray], start: int, spacing: int, tolerance: float) -> Paths:
    """Follow a grid of points of one frame both ways, until their flow there and back differs.

    Parameters
    ----------
    flows : sequence of float32 (2, y, x, 2)
        Of each of the T frames to the one before and to the one after, px/frame; the outermost two are not read.
    start : int
        Frame in which the points lie on the grid.
    spacing : int
        px.
    tolerance : float
        Largest forward-backward error, px; a twentieth of the flow is added.
    """
    height, width = flows[start].shape[1:3]
    x, y = np.meshgrid(np.arange(spacing // 2, width, spacing), np.arange(spacing // 2, height, spacing))
    grid = np.stack([x.ravel(), y.ravel()], axis=-1).astype(np.float32)
    points = np.repeat(grid[:, None], len(flows), axis=1)
    visible = np.zeros(points.shape[:2], bool)
    visible[:, start] = True
    for direction, frames in ((1, range(start, len(flows) - 1)), (0, range(start, 0, -1))):
        for frame in frames:
            other = frame + 2 * direction - 1
            moved = sample_map(flows[frame][direction], points[:, frame])
            there = points[:, frame] + moved
            back = sample_map(flows[other][1 - direction], there)
            error = np.linalg.norm(moved + back, axis=1) - 0.05 * np.linalg.norm(moved, axis=1)
            inside = (there >= 0).all(axis=1) & (there <= (width - 1, height - 1)).all(axis=1)
            visible[:, other] = visible[:, frame] & inside & (error < tolerance)
            points[:, other] = np.where(visible[:, other, None], there, points[:, frame])
    return Paths(points, visible)


def sample_map(image: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return the values (N, ...) of a map (y, x, ...) at points float32 (N, 2), bilinearly."""
    return cv2.remap(
        image, points[:, None].astype(np.float32), None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )[:, 0]
