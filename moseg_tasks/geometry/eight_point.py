"""The eight-point algorithm, batched over point sets."""

import numpy as np

from moseg.tasks.geometry.coordinates import hartley_transform
from moseg.tasks.geometry.null_vector import null_vector

SAMPLE_SIZE = 8


def eight_point(points0: np.ndarray, points1: np.ndarray, rank_two: bool = True) -> np.ndarray:
    """Return the fundamental matrices of eight or more point pairs each.

    Parameters
    ----------
    points0, points1 : float64 (..., N, 2)
        Matching points, N >= 8.
    rank_two : bool
        Whether the last step is taken, to the nearest matrix of rank 2. Without it, the matrix has any rank.

    Returns
    -------
    F : float64 (..., 3, 3)
        x1' F x0 = 0, unit Frobenius norm. Arbitrary but finite if the points do not determine it.

    References
    ----------
    R. Hartley and A. Zisserman, Multiple View Geometry, 2nd edition, algorithm 11.1.
    """
    normalised0, T0 = hartley_transform(points0)
    normalised1, T1 = hartley_transform(points1)
    F = null_vector(epipolar_equations(normalised0, normalised1)).reshape(*points0.shape[:-2], 3, 3)
    if rank_two:
        F = nearest_rank_two(F)
    F = np.swapaxes(T1, -1, -2) @ F @ T0
    return F / np.linalg.norm(F, axis=(-2, -1), keepdims=True)


def epipolar_equations(points0: np.ndarray, points1: np.ndarray) -> np.ndarray:
    """Return the rows of x1' F x0 = 0, linear in the nine entries of F (row-major): float64 (..., N, 9)."""
    x0, y0 = points0[..., 0], points0[..., 1]
    x1, y1 = points1[..., 0], points1[..., 1]
    return np.stack([x1 * x0, x1 * y0, x1, y1 * x0, y1 * y0, y1, x0, y0, np.ones_like(x0)], axis=-1)


def nearest_rank_two(F: np.ndarray) -> np.ndarray:
    """Return the matrix of rank 2 nearest to each F in Frobenius norm."""
    U, S, Vh = np.linalg.svd(F)
    return F - S[..., 2, None, None] * U[..., :, 2, None] * Vh[..., None, 2, :]
