"""Area of an object relative to what it had shortly before."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import median_filter

BEFORE = 24
"""Frames before a frame whose areas are compared with its own."""
_SMOOTHED = 5  # frames whose median area counts, so that one frame of a wrong mask does not


def kept_area(areas: np.ndarray) -> np.ndarray:
    """Return an object's area in each frame over the largest that it had in the frames before.

    An object that stops in part shrinks within a second; one that moves away shrinks slowly.

    Parameters
    ----------
    areas : integer (F,)
        px; 0 where it is not seen.

    Returns
    -------
    float64 (F,)
        0..1; 1 where it was not seen before, 0 where it is not seen.
    """
    areas = np.asarray(areas, np.float64)
    usual = median_filter(areas, _SMOOTHED, mode="nearest")
    largest = sliding_window_view(np.pad(usual, (BEFORE, 0)), BEFORE + 1).max(axis=1)
    return np.minimum(areas / np.maximum(largest, 1), 1)
