"""Least singular vectors of many small systems, without their singular value decompositions."""

import numpy as np

_NUM_SQUARINGS = 5  # the share of other singular vectors falls as (s_n / s_(n-1))^64


def least_vector(A: np.ndarray) -> np.ndarray:
    """Unit vector f minimising |A f| for each system, at a third of the cost of a singular value decomposition.

    With A = QR, powers of (R'R)^-1 turn every vector into the least one. R is inverted, not R'R, so that nothing is
    lost of an exact solution.

    Parameters
    ----------
    A : float64 (..., M, N)
        M >= N.

    Returns
    -------
    f : float64 (..., N)
        Some vector of the solution space where it has more than one dimension.
    """
    R = np.linalg.qr(A, mode="r")
    # An exact solution leaves a pivot that may be 0: one that is rounding does as well.
    rounding = np.finfo(np.float64).eps * np.maximum(np.abs(R).max(axis=(-2, -1)), np.finfo(np.float64).tiny)
    index = np.arange(R.shape[-1])
    pivots = R[..., index, index]
    R[..., index, index] = np.where(np.abs(pivots) < rounding[..., None], rounding[..., None], pivots)
    # The size goes first: squares of what follows stay in range.
    inverse = _inverse_of_triangle(R / rounding[..., None, None])
    power = inverse @ np.swapaxes(inverse, -1, -2)
    for _ in range(_NUM_SQUARINGS):
        power = power / np.abs(power).max(axis=(-2, -1), keepdims=True)
        power = power @ power
    longest = np.argmax(np.sum(power**2, axis=-2), axis=-1)
    f = np.take_along_axis(power, longest[..., None, None], axis=-1)[..., 0]
    return f / np.linalg.norm(f, axis=-1, keepdims=True)


def _inverse_of_triangle(R: np.ndarray) -> np.ndarray:
    """Inverses of upper triangular matrices (..., N, N), halved until one pivot is left."""
    if R.shape[-1] == 1:
        return 1 / R
    half = R.shape[-1] // 2
    inverse = np.zeros_like(R)
    inverse[..., :half, :half] = _inverse_of_triangle(R[..., :half, :half])
    inverse[..., half:, half:] = _inverse_of_triangle(R[..., half:, half:])
    inverse[..., :half, half:] = -inverse[..., :half, :half] @ R[..., :half, half:] @ inverse[..., half:, half:]
    return inverse
