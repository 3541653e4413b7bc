"""k-means: the optimum of a few points, found by trying every partition, and Lloyd's algorithm for more."""

from functools import lru_cache

import numpy as np

MAX_EXACT = 10
"""Ten points have 115,975 partitions, which take some 20 ms; eleven have six times as many."""
_NUM_STARTS, _SEED = 30, 0
_MAX_ROUNDS = 300


def cluster_points(points: np.ndarray, num_clusters: int) -> np.ndarray:
    """Return the label of each point in the partition of minimal inertia.

    For up to ten points it is the optimum over all partitions; for more, the best of 30 runs of Lloyd's algorithm from
    k-means++ starts, which are drawn from a fixed seed.

    Parameters
    ----------
    points : float64 (N, D)
    num_clusters : int
        k, at least 1 and at most N.

    Returns
    -------
    int64 (N,)
        Labels from 0 in the order of each cluster's first point, at most k; fewer are in use if points coincide.
    """
    if len(points) <= MAX_EXACT:
        return _best_partition(points, num_clusters)
    num_distinct = len(np.unique(points, axis=0))
    labels = cluster_many_points(points, min(num_clusters, num_distinct), _NUM_STARTS, _SEED)
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    return np.argsort(np.argsort(first))[inverse]


def cluster_many_points(points: np.ndarray, count: int, num_starts: int, seed: int) -> np.ndarray:
    """Return the label of each point in the best of several k-means runs, each with its own k-means++ start.

    All runs advance together: for a few hundred points, calls cost more than the arithmetic.

    Parameters
    ----------
    points : float64 (N, D)
    count : int
        Number of clusters, at most N.
    num_starts, seed : int

    Returns
    -------
    labels : int64 (N,)
        From 0, each in use; fewer than `count` if points coincide.

    References
    ----------
    D. Arthur and S. Vassilvitskii, "k-means++: the advantages of careful seeding", SODA 2007.
    """
    if count == 1:
        return np.zeros(len(points), dtype=np.int64)
    centres = _spread_centres(points, count, num_starts, np.random.default_rng(seed))
    labels, inertia = _descend(points, centres)
    return np.unique(labels[np.argmin(inertia)], return_inverse=True)[1]


def _spread_centres(points: np.ndarray, count: int, num_starts: int, rng: np.random.Generator) -> np.ndarray:
    """Draw the first centres of each start (starts, count, D): of a few points far from the centres, the best one."""
    num_tried = 2 + int(np.log(count))
    starts = np.arange(num_starts)
    chosen = np.empty((num_starts, count), np.int64)
    chosen[:, 0] = rng.integers(len(points), size=num_starts)
    nearest = _squared_distances(points, points[chosen[:, :1]])[..., 0]
    for index in range(1, count):
        total = np.cumsum(nearest, axis=1)
        drawn = rng.random((num_starts, num_tried)) * total[:, -1:]
        tried = np.stack([np.searchsorted(*each, side="right") for each in zip(total, drawn, strict=True)])
        tried = np.minimum(tried, len(points) - 1)
        left = np.minimum(_squared_distances(points, points[tried]), nearest[..., None])
        best = np.argmin(left.sum(axis=1), axis=1)
        chosen[:, index] = tried[starts, best]
        nearest = left[starts, :, best]
    return points[chosen]


def _descend(points: np.ndarray, centres: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Move the centres of all starts to a minimum: labels int (starts, N) and inertia float64 (starts,)."""
    count = centres.shape[1]
    labels = np.full((len(centres), len(points)), -1)
    for _ in range(_MAX_ROUNDS):
        squared = _squared_distances(points, centres)
        last, labels = labels, squared.argmin(axis=2)
        if np.array_equal(labels, last):
            break
        members = (labels[..., None] == np.arange(count)).astype(points.dtype)
        size = members.sum(axis=1)
        centres = np.swapaxes(members, 1, 2) @ points / np.maximum(size, 1)[..., None]
        for start, cluster in zip(*np.nonzero(size == 0), strict=True):
            # An unused centre moves to the point that fits worst.
            worst = np.argmax(np.take_along_axis(squared[start], labels[start][:, None], axis=1))
            centres[start, cluster] = points[worst]
            squared[start, worst] = 0
    return labels, np.take_along_axis(squared, labels[..., None], axis=2).sum(axis=(1, 2))


def _squared_distances(points: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Return the squared distances float64 (starts, N, K) of points (N, D) to centres (starts, K, D)."""
    lengths = (points**2).sum(axis=1)[:, None] + (centres**2).sum(axis=2)[:, None, :]
    return np.maximum(lengths - 2 * (points @ np.swapaxes(centres, 1, 2)), 0)


def _best_partition(points: np.ndarray, num_clusters: int) -> np.ndarray:
    """Return the labels of the partition of minimal inertia among all."""
    partitions = _partitions(len(points), num_clusters)
    inertia = _subset_inertias(points)[_subsets(len(points), num_clusters)].sum(axis=1)
    # Rounded, so that among equal partitions the one of fewest clusters is taken, independent of rounding errors.
    return partitions[np.argmin(np.round(inertia, 12))].astype(np.int64)


@lru_cache(maxsize=16)
def _partitions(num_points: int, max_clusters: int) -> np.ndarray:
    """Return every partition into at most `max_clusters` clusters, int8 (P, N), those of fewer clusters first.

    A row labels clusters in the order of their first points, so that no partition is repeated.
    """
    rows = np.zeros((1, 1), np.int8)
    for _ in range(num_points - 1):
        choices = np.minimum(rows.max(axis=1) + 2, max_clusters)
        starts = np.repeat(np.cumsum(choices) - choices, choices)
        label = (np.arange(choices.sum()) - starts).astype(np.int8)
        rows = np.column_stack([np.repeat(rows, choices, axis=0), label])
    return rows[np.argsort(rows.max(axis=1), kind="stable")]


@lru_cache(maxsize=16)
def _subsets(num_points: int, max_clusters: int) -> np.ndarray:
    """Return the clusters of every partition as bit masks of their points, int64 (P, k); 0 for empty ones."""
    partitions, bits = _partitions(num_points, max_clusters), 1 << np.arange(num_points)
    return np.stack([(partitions == label) @ bits for label in range(max_clusters)], axis=1)


def _subset_inertias(points: np.ndarray) -> np.ndarray:
    """Return the sum of squared distances to the mean of every subset of points, float64 (2^N,), by bit mask."""
    member = (np.arange(1 << len(points))[:, None] >> np.arange(len(points))) & 1
    size = np.maximum(member.sum(axis=1), 1)
    centred = points - points.mean(axis=0)
    squares = member @ (centred**2).sum(axis=1)
    return np.maximum(squares - ((member @ centred) ** 2).sum(axis=1) / size, 0.0)
