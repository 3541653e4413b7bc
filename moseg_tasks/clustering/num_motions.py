"""How many motions a spectrum shows."""

import numpy as np


def count_by_eigengap(eigenvalues: np.ndarray) -> int:
    """Number of eigenvalues before the largest drop.

    Parameters
    ----------
    eigenvalues : float64 (V, K)
        Of each view's normalised affinity, descending, averaged here over views. A zero follows them, so that K motions
        of one object each are a possible answer.

    Returns
    -------
    int
        1 .. K.

    References
    ----------
    U. von Luxburg, "A tutorial on spectral clustering", Statistics and Computing 17, 2007, section 8.3.
    """
    return int(np.argmax(-np.diff(np.append(eigenvalues.mean(axis=0), 0.0)))) + 1
