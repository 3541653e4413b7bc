"""Flow on a coarser grid than its frames: that of the resolution at which its search ends."""

import cv2
import numpy as np


def enlarge_flow(flow: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Interpolate a flow between the vectors of its grid, bilinear.

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
    return cv2.resize(flow, (width, height), interpolation=cv2.INTER_LINEAR)
