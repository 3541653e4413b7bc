"""Leading eigenvalues and eigenvectors of symmetric matrices of ten objects or hundreds of trajectories."""

import numpy as np
from scipy.sparse.linalg import eigsh

_DENSE = 200
"""Side of a matrix below which all eigenvectors cost less than the iteration for a few."""
_TOLERANCE = 1e-8


def leading_eigenpairs(symmetric: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """The largest eigenvalues of a symmetric matrix and their vectors.

    Parameters
    ----------
    symmetric : float64 (N, N)
    count : int
        At most N.

    Returns
    -------
    eigenvalues : float64 (count,)
        Descending.
    vectors : float64 (N, count)
        Orthonormal; of signs that do not depend on the solver.
    """
    num = len(symmetric)
    if not symmetric.any():
        return np.zeros(count), np.eye(num, count)
    if num < _DENSE or count > num // 4:
        values, vectors = np.linalg.eigh(symmetric)
    else:
        # A start of its own would be random, and so would be new ones where the first spans too little.
        start, rng = np.full(num, num**-0.5), np.random.default_rng(0)
        values, vectors = eigsh(symmetric, count, which="LA", v0=start, tol=_TOLERANCE, rng=rng)
    order = np.argsort(-values, kind="stable")[:count]
    vectors = vectors[:, order]
    largest = vectors[np.argmax(np.abs(vectors), axis=0), np.arange(vectors.shape[1])]
    return values[order], vectors * np.where(largest < 0, -1.0, 1.0)
