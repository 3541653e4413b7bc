"""k-means of a few points, without randomness."""

import numpy as np

_MAX_ROUNDS = 100  # Lloyd's updates of tens of points settle within a few rounds


def cluster_points(points: np.ndarray, num_clusters: int) -> np.ndarray:
    """Label of each point in the best of N k-means runs, each started from another point.

    A start takes the point farthest from those already taken, so neither the order of the points nor a random number
    decides; with tens of points all N starts are cheap.

    Parameters
    ----------
    points : float64 (N, D)
    num_clusters : int
        k, at most N.

    Returns
    -------
    int64 (N,)
        Labels 0 .. k - 1; fewer are in use where points coincide.
    """
    runs = [_lloyd(points, _farthest_first(points, start, num_clusters)) for start in range(len(points))]
    return min(runs, key=lambda run: run[0])[1]


def _farthest_first(points: np.ndarray, start: int, num_clusters: int) -> np.ndarray:
    chosen = [start]
    distance = ((points - points[start]) ** 2).sum(axis=1)
    for _ in range(num_clusters - 1):
        chosen.append(int(np.argmax(distance)))
        distance = np.minimum(distance, ((points - points[chosen[-1]]) ** 2).sum(axis=1))
    return points[chosen]


def _lloyd(points: np.ndarray, centres: np.ndarray) -> tuple[float, np.ndarray]:
    """Inertia, rounded so that equal solutions compare equal, and labels."""
    labels = None
    for _ in range(_MAX_ROUNDS):
        squared = ((points[:, None, :] - centres[None, :, :]) ** 2).sum(axis=2)
        nearest = squared.argmin(axis=1)
        if labels is not None and np.array_equal(nearest, labels):
            break
        labels = nearest
        centres = np.stack(
            [points[labels == c].mean(axis=0) if (labels == c).any() else centres[c] for c in range(len(centres))]
        )
    return round(float(squared.min(axis=1).sum()), 12), labels
