"""How many motions an embedding or a spectrum shows."""

import numpy as np

from moseg_tasks.clustering.kmeans import cluster_points
from moseg_tasks.clustering.spectral import embed_views


def count_by_eigengap(views: np.ndarray) -> int:
    """Number of motions before the largest drop of the views' mean eigenvalues; 1 where no drop exceeds that to the end.

    Parameters
    ----------
    views : float64 (V, K, K)
        Affinities; their normalised eigenvalues lie in -1..1 and are followed by a zero here, so that K groups of one
        object each are a possible answer.

    References
    ----------
    U. von Luxburg, "A tutorial on spectral clustering", Statistics and Computing 17, 2007, section 8.3.
    """
    eigenvalues = embed_views(views, 1, 0.0, 1, 0.0).eigenvalues.mean(axis=0)
    return int(np.argmax(-np.diff(np.append(eigenvalues, 0.0)))) + 1
