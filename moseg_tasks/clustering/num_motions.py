"""How many motions a spectrum shows."""

import numpy as np


def count_by_eigengap(eigenvalues: np.ndarray, most: int | None = None) -> int:
    """Number of eigenvalues before the largest drop.

    Parameters
    ----------
    eigenvalues : float64 (V, E)
        Of each view's normalised affinity, descending, averaged here over views. A zero follows them where they are
        all, so that K motions of one object each are a possible answer.
    most : int, optional
        Largest answer; None where the eigenvalues are all.

    Returns
    -------
    int
        1 .. K, or `most`.

    References
    ----------
    U. von Luxburg, "A tutorial on spectral clustering", Statistics and Computing 17, 2007, section 8.3.
    """
    mean = eigenvalues.mean(axis=0)
    mean = np.append(mean, 0.0) if most is None or len(mean) <= most else mean[: most + 1]
    return int(np.argmax(-np.diff(mean))) + 1
