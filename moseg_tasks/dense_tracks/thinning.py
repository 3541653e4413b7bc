"""Distances of the points of a frame: new corners away from old points, and one point in each cell."""

import cv2
import numpy as np

from moseg.schemas.parameters import DenseTrackParams


def new_corners(gray: np.ndarray, taken: np.ndarray, params: DenseTrackParams) -> np.ndarray:
    """Return Shi-Tomasi corners away from existing points and the border, as many as there is room for.

    Parameters
    ----------
    gray : uint8 (y, x)
    taken : float32 (M, 2)
        xy of existing points, inside the frame, px.
    params : DenseTrackParams

    Returns
    -------
    float32 (N, 2)
        Strongest first; N + M <= `params.max_points`.

    References
    ----------
    J. Shi and C. Tomasi, Good features to track, CVPR 1994.
    """
    room = params.max_points - len(taken)
    free = np.zeros(gray.shape, np.uint8)
    border = params.border
    free[border:-border, border:-border] = 255
    free[_near(taken, gray.shape, params.corner_distance - 1)] = 0
    if room <= 0 or not free.any():
        return np.zeros((0, 2), np.float32)
    quality, distance = params.corner_quality, params.corner_distance
    corners = cv2.goodFeaturesToTrack(gray, room, quality, distance, mask=free, blockSize=params.corner_block)
    return np.zeros((0, 2), np.float32) if corners is None else corners.reshape(-1, 2)


def _near(points: np.ndarray, shape: tuple[int, int], radius: int) -> np.ndarray:
    """Return which pixels of a frame lie in a disc of `radius` px around one of the points (N, 2): bool (y, x)."""
    x, y = points.astype(int).T
    marked = np.zeros(shape, np.uint8)
    marked[y, x] = 1
    disc = cv2.circle(np.zeros((2 * radius + 1,) * 2, np.uint8), (radius, radius), radius, 1, cv2.FILLED)
    # One dilation takes a third of the time of thousands of discs drawn one by one.
    return cv2.dilate(marked, disc).view(bool)


def first_in_cells(points: np.ndarray, cell: float) -> np.ndarray:
    """Return the indices, ascending, of the first of the points (N, 2) in each square cell of side `cell`, px."""
    column, row = np.floor(points.T / cell).astype(np.int64)
    _, first = np.unique(row * (1 << 32) + column, return_index=True)
    return np.sort(first)
