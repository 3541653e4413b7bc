"""The working grid of a frame, and images and flow on it."""

from functools import lru_cache

import cv2
import numpy as np

from moseg.tasks.frame_grid import resample


def reduce_frame(frame: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return `frame` uint8 (y, x, 3) on a grid of `shape`, float32 grey levels."""
    return resample(frame, shape).astype(np.float32)


def reduce_flow(flow: np.ndarray, shape: tuple[int, int], frame_shape: tuple[int, int] | None = None) -> np.ndarray:
    """Convert a flow to a grid of `shape`, in px of that grid per frame.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame of the frames. Of their size, or on the coarser grid of its search: where that is no coarser than the
        grid asked for, its vectors are averaged over the cells, else they are interpolated.
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
