"""Least-squares solutions of unit norm of stacks of homogeneous linear systems."""

import numpy as np

_NUM_SQUARINGS = 5  # the share of other singular vectors falls as (s_n / s_(n-1))^64


def null_vector(A: np.ndarray) -> np.ndarray:
    """Return the unit vector f that minimises |A f| for each system.

    A system with one equation less than unknowns has an exact solution: the last column of Q in the QR decomposition
    of A', which costs a sixth of a singular value decomposition and is as stable.

    Parameters
    ----------
    A : float64 (..., M, N)
        M >= N - 1 equations in N unknowns.

    Returns
    -------
    f : float64 (..., N)
    """
    if A.shape[-2] == A.shape[-1] - 1:
        return np.linalg.qr(np.swapaxes(A, -1, -2), mode="complete").Q[..., -1]
    return np.linalg.svd(A, full_matrices=False).Vh[..., -1, :]


def iterated_null_vector(A: np.ndarray) -> np.ndarray:
    """Return the same as `null_vector` for M >= N, at a third of the cost of a singular value decomposition.

    With A = QR, powers of (R'R)^-1 turn every vector into the null vector. R is inverted, not R'R, so that an exact
    solution keeps its precision.

    Parameters
    ----------
    A : float64 (..., M, N)
        M >= N.

    Returns
    -------
    f : float64 (..., N)
        Any vector of the solution space where that has more than one dimension.
    """
    R = np.linalg.qr(A, mode="r")
    # An exact solution may leave a pivot of 0; a pivot of the size of rounding gives the same vector.
    rounding = np.finfo(np.float64).eps * np.maximum(np.abs(R).max(axis=(-2, -1)), np.finfo(np.float64).tiny)
    index = np.arange(R.shape[-1])
    pivots = R[..., index, index]
    R[..., index, index] = np.where(np.abs(pivots) < rounding[..., None], rounding[..., None], pivots)
    # Divided by the size first, so that the squares below stay in range.
    inverse = _invert_triangle(R / rounding[..., None, None])
    power = inverse @ np.swapaxes(inverse, -1, -2)
    for _ in range(_NUM_SQUARINGS):
        power = power / np.abs(power).max(axis=(-2, -1), keepdims=True)
        power = power @ power
    longest = np.argmax(np.sum(power**2, axis=-2), axis=-1)
    f = np.take_along_axis(power, longest[..., None, None], axis=-1)[..., 0]
    return f / np.linalg.norm(f, axis=-1, keepdims=True)


def _invert_triangle(R: np.ndarray) -> np.ndarray:
    """Return the inverses of upper triangular matrices (..., N, N), by halving them recursively."""
    if R.shape[-1] == 1:
        return 1 / R
    half = R.shape[-1] // 2
    inverse = np.zeros_like(R)
    inverse[..., :half, :half] = _invert_triangle(R[..., :half, :half])
    inverse[..., half:, half:] = _invert_triangle(R[..., half:, half:])
    inverse[..., :half, half:] = -inverse[..., :half, :half] @ R[..., :half, half:] @ inverse[..., half:, half:]
    return inverse
