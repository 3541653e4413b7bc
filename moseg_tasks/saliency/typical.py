"""The residual that a background leaves where it is the background."""

import numpy as np


def typical_residual(residual: np.ndarray, border_band: float) -> float:
    """Median of a residual float32 (y, x), over the whole frame or over the band along its border, if that is less.

    An object that fills more than half of the frame would make its own residual the usual one.
    """
    width = max(1, round(border_band * residual.shape[0]))
    in_band = np.ones(residual.shape, bool)
    in_band[width:-width, width:-width] = False
    return min(float(np.median(residual)), float(np.median(residual[in_band])))
