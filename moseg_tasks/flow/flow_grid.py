"""Flow on another grid than its frames': that at which its search ends."""

import cv2
import numpy as np

SIZE = "frame_size"
"""Attribute of a stored flow on another grid than its frames': their height and width, px."""


def full_flow(flow: np.ndarray, attributes: dict) -> np.ndarray:
    """Return a stored flow at its frames' size, float32 (y, x, 2), px/frame, from its array and attributes."""
    return resize_flow(flow, tuple(attributes[SIZE])) if SIZE in attributes else flow


def resize_flow(flow: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Interpolate a flow between the vectors of its grid, bilinear, or average those of a grid finer than the frames.

    Parameters
    ----------
    flow : float32 (grid y, grid x, 2)
        px/frame of the frames, whatever the grid.
    shape : (height, width)
        Of the frames, px.

    Returns
    -------
    flow : float32 (y, x, 2)
        px/frame; `flow` itself if it has this shape.
    """
    height, width = shape
    if flow.shape[:2] == (height, width):
        return flow
    is_finer = flow.shape[0] * flow.shape[1] > height * width
    return cv2.resize(flow, (width, height), interpolation=cv2.INTER_AREA if is_finer else cv2.INTER_LINEAR)
