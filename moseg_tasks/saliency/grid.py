"""Positions, warps and lengths of vectors on the working grid."""

from functools import lru_cache

import cv2
import numpy as np


@lru_cache(maxsize=4)
def pixel_grid(shape: tuple[int, int]) -> np.ndarray:
    """Return the xy position float32 (y, x, 2) of every pixel of a grid of `shape`, read-only."""
    height, width = shape
    x, y = np.meshgrid(np.arange(width, dtype=np.float32), np.arange(height, dtype=np.float32))
    grid = np.stack([x, y], axis=-1)
    grid.flags.writeable = False
    return grid


def warp(image: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """Sample `image` float32 (y, x) or (y, x, channel) where `flow` leads from each pixel, bilinear."""
    position = pixel_grid(flow.shape[:2]) + flow
    warped = cv2.remap(image, position, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    return warped.reshape(image.shape)


def squared_length(vectors: np.ndarray) -> np.ndarray:
    """Return the squared length (...) of vectors (..., 2)."""
    squared = vectors * vectors
    return squared[..., 0] + squared[..., 1]


def vector_length(vectors: np.ndarray) -> np.ndarray:
    """Return the length (...) of vectors (..., 2)."""
    # Not cv2.magnitude: its last bit depends on where in memory the arrays lie.
    return np.sqrt(squared_length(vectors))
