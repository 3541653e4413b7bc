"""Quantiles of values of which some are unknown."""

import numpy as np


def known_quantile(values: np.ndarray, quantile: float) -> np.ndarray:
    """Return the quantile of the known values over the first axis, NaN where none is known.

    `numpy.nanquantile` would warn there, and warnings are switched off for all threads of a process at once.

    Parameters
    ----------
    values : float64 (M, ...)
        NaN where unknown.
    quantile : float
        0..1.

    Returns
    -------
    float64 (...)
    """
    is_known = ~np.isnan(values).all(axis=0)
    found = np.full(values.shape[1:], np.nan)
    found[is_known] = np.nanquantile(values[:, is_known], quantile, axis=0)
    return found
