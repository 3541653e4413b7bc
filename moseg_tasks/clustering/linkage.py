"""Agglomerative clustering by mean affinity, around the background."""

import numpy as np

_TIE = 1e-12  # affinities closer than this are equal up to rounding


def link_objects(
    affinity: np.ndarray, *, num_clusters: int | None = None, threshold: float | None = None
) -> np.ndarray:
    """Merge groups in the order of the affinity between them.

    The affinity of two groups is the mean over their members (average linkage). Only object 0 represents the
    background's group: it covers most of the frame, so its model is the most accurate, while small static objects
    predict each other badly and would keep others from joining. Of equal affinities, pairs without the background are
    merged first.

    Parameters
    ----------
    affinity : float64 (K, K)
        Symmetric; object 0 is the background.
    num_clusters : int, optional
        Merging stops at this many groups.
    threshold : float, optional
        Merging stops when no two groups have this affinity; one of the two is given.

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
