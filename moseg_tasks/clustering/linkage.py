"""Agglomerative clustering by mean affinity, around the background."""

import numpy as np

_TIE = 1e-12  # affinities closer than this are equal: only rounding tells them apart


def link_objects(
    affinity: np.ndarray, *, num_clusters: int | None = None, threshold: float | None = None
) -> np.ndarray:
    """Groups merged in the order of the affinity between them.

    Two groups are as alike as their members are in the mean (average linkage). The background's group is represented by
    object 0 alone: it covers most of the frame, so its model is the best known, while its small static companions
    predict little of one another and would hold the next one off. Equal affinities merge objects before they join the
    background.

    Parameters
    ----------
    affinity : float64 (K, K)
        Symmetric; object 0 is the background.
    num_clusters : int, optional
        Merging stops at this many groups.
    threshold : float, optional
        Merging stops when no two groups are as alike as this; one of the two is given.

    Returns
    -------
    int64 (K,)
        Labels in the order of each group's first object: the background's is 0.
    """
    groups = [[k] for k in range(len(affinity))]
    while len(groups) > (num_clusters or 1):
        means = np.full((len(groups), len(groups)), -np.inf)
        for a, b in zip(*np.triu_indices(len(groups), 1), strict=True):
            first = [0] if a == 0 else groups[a]
            means[a, b] = affinity[np.ix_(first, groups[b])].mean()
        best = means.max()
        if threshold is not None and best < threshold:
            break
        a, b = max(zip(*np.nonzero(means >= best - _TIE), strict=True), key=lambda pair: pair[0] != 0)
        groups[a] += groups.pop(b)
    labels = np.zeros(len(affinity), dtype=np.int64)
    for label, group in enumerate(groups):
        labels[group] = label
    return labels
