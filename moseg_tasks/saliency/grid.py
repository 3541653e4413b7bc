"""The working grid: the frame reduced by area to a fixed longer side."""

from functools import lru_cache

import cv2
import numpy as np


def working_shape(shape: tuple[int, int], working_side: int) -> tuple[int, int]:
    """Height and width of the working grid of a frame of `shape` (y, x): longer side `working_side`, never enlarged."""
    height, width = shape
    scale = min(1.0, working_side / max(height, width))
    return max(1, round(height * scale)), max(1, round(width * scale))


def reduce_frame(frame: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """`frame` uint8 (y, x, 3) averaged over the cells of a grid of `shape`, float32 grey levels."""
    height, width = shape
    if frame.shape[:2] == (height, width):
        return frame.astype(np.float32)
    return cv2.resize(frame, (width, height), interpolation=cv2.INTER_AREA).astype(np.float32)


def reduce_flow(flow: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """`flow` float32 (y, x, 2) averaged over the cells of a grid of `shape`, in px of that grid per frame."""
    height, width = shape
    full_height, full_width = flow.shape[:2]
    if (full_height, full_width) == (height, width):
        return flow.astype(np.float32)
    reduced = cv2.resize(flow, (width, height), interpolation=cv2.INTER_AREA)
    return reduced * np.array([width / full_width, height / full_height], np.float32)


@lru_cache(maxsize=4)
def pixel_grid(shape: tuple[int, int]) -> np.ndarray:
    """float32 (y, x, 2) xy position of every pixel of a grid of `shape`, read-only."""
    height, width = shape
    x, y = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    grid = np.stack([x, y], axis=-1)
    grid.flags.writeable = False
    return grid


def vector_length(vectors: np.ndarray) -> np.ndarray:
    """Length float32 (y, x) of vectors float32 (y, x, 2)."""
    # Not cv2.magnitude: its last bit depends on where in memory the arrays lie.
    squared = vectors * vectors
    return np.sqrt(squared[..., 0] + squared[..., 1])
