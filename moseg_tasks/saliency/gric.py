"""Geometric robust information criterion (GRIC): models of different dimension compared on the same data."""

import math

import numpy as np


def gric(residual: np.ndarray, noise: float, dimension: int, num_parameters: int) -> float:
    """Return the GRIC per datum of a model for flow or matches; the model with the lowest explains them best.

    ``(sum min(e^2 / sigma^2, 2 (r - d)) + d n ln r + k ln(r n)) / n`` for n data of dimension r = 4.

    Parameters
    ----------
    residual : float (n,)
        Distance of each datum to the model, px, outliers included.
    noise : float
        Standard deviation sigma of a datum, px.
    dimension : int
        Dimension d of the model's manifold: 2 for motion that maps a pixel to a point, 3 for motion that maps it to a
        line.
    num_parameters : int
        The model's parameters k.

    Returns
    -------
    float

    References
    ----------
    P. Torr, A. Fitzgibbon and A. Zisserman, The problem of degeneracy in structure and motion recovery from
    uncalibrated image sequences, IJCV 1999, eqs. 12 to 14.
    """
    datum = 4
    count = residual.size
    residual_sum = np.minimum((residual.astype(np.float64) / noise) ** 2, 2 * (datum - dimension)).sum()
    return float(residual_sum + dimension * count * math.log(datum) + num_parameters * math.log(datum * count)) / count
