"""Squared Sampson distance: how far, to first order, a point pair must move to obey an epipolar geometry."""

import numpy as np

from moseg.tasks.geometry.coordinates import homogeneous


def sampson_squared(F: np.ndarray, points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Squared Sampson distance of every point pair to every fundamental matrix.

    Parameters
    ----------
    F : float64 (..., 3, 3)
    points0, points1 : float64 (N, 2)

    Returns
    -------
    squared : float64 (..., N)
        (x1' F x0)^2 / (|F x0|^2 + |F' x1|^2) with the norms over the first two coordinates; px^2 where the points are
        in pixels. 0 where a point sits on its epipole, whose epipolar line is every line.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, eq. 11.9.
    """
    x0, x1 = homogeneous(points0), homogeneous(points1)
    lines1 = x0 @ np.swapaxes(F, -1, -2)
    lines0 = x1 @ F
    algebraic = np.sum(x1 * lines1, axis=-1)
    gradient = np.sum(lines1[..., :2] ** 2, axis=-1) + np.sum(lines0[..., :2] ** 2, axis=-1)
    # At an epipole both vanish, numerator first.
    return algebraic**2 / np.maximum(gradient, np.finfo(np.float64).tiny)
