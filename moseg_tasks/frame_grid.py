"""Grids of a fixed longer side, on which frames are analysed, and frames and flow on them."""

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


def frame_on_grid(frame: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return a frame uint8 (y, x, 3) on a grid of (height, width) `shape`, float32 grey levels."""
    return resample(frame, shape).astype(np.float32)


def flow_on_grid(flow: np.ndarray, shape: tuple[int, int], frame_shape: tuple[int, int] | None = None) -> np.ndarray:
    """Convert a flow to a grid of `shape`, in px of that grid per frame.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame of the frames. Of their size, or on the grid of its search: where that is no coarser than the grid
        asked for, its vectors are averaged over the cells, else they are interpolated.
    shape : (height, width)
        Of the grid.
    frame_shape : (height, width), optional
        Of the frames, px; by default the flow's.

    Returns
    -------
    float32 (height, width, 2)
    """
    height, width = shape
    full_height, full_width = frame_shape or flow.shape[:2]
    if flow.shape[:2] != (height, width):
        is_finer = flow.shape[0] >= height and flow.shape[1] >= width
        flow = cv2.resize(flow, (width, height), interpolation=cv2.INTER_AREA if is_finer else cv2.INTER_LINEAR)
    if (full_height, full_width) == (height, width):
        return flow.astype(np.float32)
    scale = np.array([width / full_width, height / full_height, 0, 0], np.float32)
    return cv2.multiply(flow, tuple(scale.tolist()), dtype=cv2.CV_32F)


def _scaled(shape: tuple[int, int], scale: float) -> tuple[int, int]:
    height, width = shape
    return max(1, round(height * scale)), max(1, round(width * scale))
