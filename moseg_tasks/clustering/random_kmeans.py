"""k-means of many points, from random starts."""

import numpy as np


def cluster_many_points(points: np.ndarray, count: int, num_starts: int, seed: int) -> np.ndarray:
    """Label of each point in the best of some k-means runs, each with starts of its own (k-means++).

    Parameters
    ----------
    points : float64 (N, D)
    count : int
        Number of clusters, at most N.
    num_starts, seed : int

    Returns
    -------
    labels : int64 (N,)
        From 0, each in use; fewer than `count` where points coincide.

    References
    ----------
    D. Arthur and S. Vassilvitskii, "k-means++: the advantages of careful seeding", SODA 2007.
    """
    # With scipy.stats behind it, it takes half a second to import, which every process would pay at its start.
    from sklearn.cluster import KMeans

    if count == 1:
        return np.zeros(len(points), dtype=np.int64)
    labels = KMeans(count, n_init=num_starts, random_state=seed).fit(points).labels_
    return np.unique(labels, return_inverse=True)[1]
