"""The vector that a stack of homogeneous linear systems sends nearest to zero."""

import numpy as np


def null_vector(A: np.ndarray) -> np.ndarray:
    """Unit vector f minimising |A f| for each system.

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
