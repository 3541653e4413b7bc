"""Agglomerative clustering by mean affinity."""

import numpy as np


def link_objects(affinity: np.ndarray, num_clusters: int | None, threshold: float) -> np.ndarray:
    """Groups merged by the largest mean affinity between their members (average linkage).

    Parameters
    ----------
    affinity : float64 (K, K)
        Symmetric.
    num_clusters : int, optional
        Merging stops at this many groups; where None, when no two groups have a mean affinity of `threshold`.
    threshold : float

    Returns
    -------
    int64 (K,)
        Labels, in the order of each group's first object.
    """
    groups = [[k] for k in range(len(affinity))]
    while len(groups) > (num_clusters or 1):
        means = np.full((len(groups), len(groups)), -np.inf)
        for a, b in zip(*np.triu_indices(len(groups), 1), strict=True):
            means[a, b] = affinity[np.ix_(groups[a], groups[b])].mean()
        first, second = np.unravel_index(np.argmax(means), means.shape)
        if num_clusters is None and means[first, second] < threshold:
            break
        groups[first] += groups.pop(second)
    labels = np.zeros(len(affinity), dtype=np.int64)
    for label, group in enumerate(groups):
        labels[group] = label
    return labels
