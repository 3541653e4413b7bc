"""Area of an object relative to what it had shortly before."""

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy.ndimage import median_filter

BEFORE = 24
"""Frames before a frame whose areas are compared with its own."""
_SMOOTHED = 5  # frames whose median area counts, so that one frame of a wrong mask does not


def kept_area(areas: np.ndarray, growth: np.ndarray | None = None) -> np.ndarray:
    """Return an object's area in each frame over the largest that it had in the frames before.

    An object that stops in part shrinks within a second. One that goes away shrinks too, but as its flow says: the
    areas before are compared as large as they would appear now, where that is smaller.

    Parameters
    ----------
    areas : integer (F,)
        px; 0 where it is not seen.
    growth : float64 (F,), optional
        Logarithm of the area over that in the frame before, by the object's flow; 0 where that is not known.

    Returns
    -------
    float64 (F,)
        0..1; 1 where it was not seen before, 0 where it is not seen.
    """
    areas = np.asarray(areas, np.float64)
    usual = median_filter(areas, _SMOOTHED, mode="nearest")
    before = _windows(usual)
    if growth is not None:
        grown = np.cumsum(growth)
        before = before * np.exp(np.minimum(grown[:, None] - _windows(grown), 0))
    return np.minimum(areas / np.maximum(before.max(axis=1), 1), 1)


def _windows(values: np.ndarray) -> np.ndarray:
    """Return the values of each frame and of those before it, float64 (F, BEFORE + 1); 0 before the first frame."""
    return sliding_window_view(np.pad(values, (BEFORE, 0)), BEFORE + 1)
