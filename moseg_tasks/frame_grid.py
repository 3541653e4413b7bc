"""Grids of a fixed longer side, on which frames are analysed."""

import cv2
import numpy as np

MAX_ENLARGEMENT = 2
"""Sides of a grid in those of its frame, at most: between pixels all is interpolated, and finer grids add nothing."""
MIN_ENLARGEMENT = 1.1
"""Below it the grid is that of the frame, which interpolation would blur for nothing."""


def grid_shape(shape: tuple[int, int], side: int) -> tuple[int, int]:
    """Return (height, width) of a frame's grid: longer side `side`, up to a tenth less, or twice that of the frame."""
    scale = min(MAX_ENLARGEMENT, side / max(shape))
    return _scaled(shape, 1 if 1 < scale < MIN_ENLARGEMENT else scale)


def reduced_shape(shape: tuple[int, int], side: int) -> tuple[int, int]:
    """Return (height, width) of a grid with longer side `side`, or of that of the frame where it is shorter."""
    return _scaled(shape, min(1, side / max(shape)))


def resample(image: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return an image uint8 (y, x) or (y, x, 3) on a grid of (height, width) `shape`; itself if it has this size.

    It is averaged over the cells of a coarser grid, and interpolated by cubics on a finer one.
    """
    if image.shape[:2] == tuple(shape):
        return image
    height, width = shape
    is_finer = height * width > image.shape[0] * image.shape[1]
    return cv2.resize(image, (width, height), interpolation=cv2.INTER_CUBIC if is_finer else cv2.INTER_AREA)


def _scaled(shape: tuple[int, int], scale: float) -> tuple[int, int]:
    height, width = shape
    return max(1, round(height * scale)), max(1, round(width * scale))
