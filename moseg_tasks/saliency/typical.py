"""The residual that a background leaves where it is the background."""

import numpy as np


def typical_residual(residual: np.ndarray, border_band: float) -> float:
    """Median of a residual float32 (y, x), over the whole frame or over the band along its border, if that is less.

    An object that fills more than half of the frame would make its own residual the usual one.
    """
    # Neighbours are alike: every other row and column tells as much.
    some = residual[::2, ::2]
    width = max(1, round(border_band * some.shape[0]))
    in_band = np.ones(some.shape, bool)
    in_band[width:-width, width:-width] = False
    return min(float(np.median(some)), float(np.median(some[in_band])))
