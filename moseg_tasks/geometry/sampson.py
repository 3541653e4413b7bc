"""Squared Sampson distance: how far, to first order, a point pair must move to obey an epipolar geometry.

`sampson_squared` evaluates it directly. Its denominator, the squared gradient of the epipolar error, is also written as
a matrix product of coefficients and monomials, for code that evaluates many matrices on many points.
"""

import numpy as np

from moseg.tasks.geometry.coordinates import homogeneous


def sampson_squared(F: np.ndarray, points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the squared Sampson distance of every point pair to every fundamental matrix.

    Parameters
    ----------
    F : float64 (..., 3, 3)
    points0, points1 : float64 (N, 2)

    Returns
    -------
    squared : float64 (..., N)
        (x1' F x0)^2 / (|F x0|^2 + |F' x1|^2) with the norms over the first two coordinates; px^2 if the points are
        in pixels. 0 for a point on its epipole, where the epipolar line is undefined.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, eq. 11.9.
    """
    x0, x1 = homogeneous(points0), homogeneous(points1)
    lines1 = x0 @ np.swapaxes(F, -1, -2)
    lines0 = x1 @ F
    algebraic = np.sum(x1 * lines1, axis=-1)
    gradient = np.sum(lines1[..., :2] ** 2, axis=-1) + np.sum(lines0[..., :2] ** 2, axis=-1)
    # At an epipole both vanish, the numerator faster.
    return algebraic**2 / np.maximum(gradient, np.finfo(np.float64).tiny)


def gradient_coefficients(F: np.ndarray) -> np.ndarray:
    """Return |F x0|^2 + |F' x1|^2, over the first two coordinates, as coefficients of `gradient_monomials`.

    F is float64 (..., 3, 3), the coefficients are float64 (..., 12).
    """
    rows, columns = F[..., :2, :], F[..., :2]
    gradient0 = quadratic_coefficients(np.swapaxes(rows, -1, -2) @ rows)
    gradient1 = quadratic_coefficients(columns @ np.swapaxes(columns, -1, -2))
    return np.concatenate([gradient0, gradient1], axis=-1)


def gradient_monomials(points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the quadratic monomials of points (..., N, 2) of both frames: (..., 12, N)."""
    return np.concatenate([quadratic_monomials(points0), quadratic_monomials(points1)], axis=-2)


def quadratic_coefficients(Q: np.ndarray) -> np.ndarray:
    """Return x'Qx, Q symmetric (..., 3, 3), as coefficients (..., 6) of `quadratic_monomials`."""
    return Q[..., [0, 0, 0, 1, 1, 2], [0, 1, 2, 1, 2, 2]] * [1, 2, 2, 1, 2, 1]


def quadratic_monomials(points: np.ndarray) -> np.ndarray:
    """Return xx, xy, x, yy, y and 1 of points (..., N, 2): (..., 6, N)."""
    x, y = points[..., 0], points[..., 1]
    return np.stack([x * x, x * y, x, y * y, y, np.ones_like(x)], axis=-2)
