"""Homographies by the direct linear transform, and the squared Sampson distance to them."""

import numpy as np

from moseg.tasks.geometry.coordinates import hartley_transform, homogeneous
from moseg.tasks.geometry.null_vector import null_vector

SAMPLE_SIZE = 4


def homography_dlt(points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the homographies of four or more point pairs each.

    Parameters
    ----------
    points0, points1 : float64 (..., N, 2)
        Matching points, N >= 4.

    Returns
    -------
    H : float64 (..., 3, 3)
        x1 ~ H x0, unit Frobenius norm. Arbitrary but finite if the points do not determine it.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, algorithm 4.2.
    """
    normalised0, T0 = hartley_transform(points0)
    normalised1, T1 = hartley_transform(points1)
    H = null_vector(transfer_equations(normalised0, normalised1)).reshape(*points0.shape[:-2], 3, 3)
    H = np.linalg.inv(T1) @ H @ T0
    return H / np.linalg.norm(H, axis=(-2, -1), keepdims=True)


def transfer_equations(points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return two rows of x1 x (H x0) = 0 per point pair, linear in the entries of H: float64 (..., 2 N, 9)."""
    x0 = homogeneous(points0)
    zero = np.zeros_like(x0)
    rows_x = np.concatenate([x0, zero, -points1[..., 0, None] * x0], axis=-1)
    rows_y = np.concatenate([zero, x0, -points1[..., 1, None] * x0], axis=-1)
    return np.concatenate([rows_x, rows_y], axis=-2)


def homography_sampson_squared(H: np.ndarray, points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the squared Sampson distance of every point pair to every homography.

    It measures the same as `sampson_squared` (the smallest squared displacement of both points together, to first
    order), so the two are comparable; the transfer error of a near-isometry is twice as large.

    Parameters
    ----------
    H : float64 (..., 3, 3)
    points0, points1 : float64 (N, 2)

    Returns
    -------
    squared : float64 (..., N)
        e' (J J')^-1 e with e the two transfer equations and J their derivative by (x0, y0, x1, y1); px^2 if the
        points are in pixels.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, section 4.2.6.
    """
    transferred = homogeneous(points0) @ np.swapaxes(H, -1, -2)
    weight = transferred[..., 2]
    error = transferred[..., :2] - points1 * weight[..., None]
    # d error / d x0, entry by entry because sums over two are slow; the derivative by x1 is -weight times the identity.
    (J00, J01), (J10, J11) = (
        [H[..., None, row, column] - points1[:, row] * H[..., None, 2, column] for column in (0, 1)] for row in (0, 1)
    )
    a = J00**2 + J01**2 + weight**2
    c = J10**2 + J11**2 + weight**2
    b = J00 * J10 + J01 * J11
    determinant = np.maximum(a * c - b**2, np.finfo(np.float64).tiny)
    return (c * error[..., 0] ** 2 - 2 * b * error[..., 0] * error[..., 1] + a * error[..., 1] ** 2) / determinant
