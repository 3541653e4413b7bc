"""k-medoids of an object's pixels, which cover it evenly."""

import numpy as np

from moseg.tasks.tracks.spacing import far_from

_MAX_ROUNDS = 20


def covering_medoids(
    mask: np.ndarray,
    num_points: int,
    *,
    num_candidates: int,
    spacing: float,
    taken: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return medoids of a random sample of a mask's pixels, at a distance from existing points.

    Parameters
    ----------
    mask : bool (y, x)
    num_points : int
        Maximal number of medoids.
    num_candidates : int
        Pixels drawn: the cost grows with their square.
    spacing : float
        Minimal distance of a candidate to existing points, px.
    taken : float32 (M, 2)
        xy of existing points, px.
    rng : numpy.random.Generator

    Returns
    -------
    points : float32 (P, 2)
        P <= num_points.

    References
    ----------
    H.-S. Park and C.-H. Jun, A simple and fast algorithm for k-medoids clustering, 2009;
    T. F. Gonzalez, Clustering to minimize the maximum intercluster distance, 1985, for the start.
    """
    y, x = np.nonzero(mask)
    drawn = rng.choice(len(x), size=min(num_candidates, len(x)), replace=False)
    candidates = np.stack([x[drawn], y[drawn]], axis=1).astype(np.float32)
    candidates = candidates[far_from(candidates, taken, spacing)]
    num_points = min(num_points, len(candidates))
    if num_points == 0:
        return np.zeros((0, 2), dtype=np.float32)
    distances = np.linalg.norm(candidates[:, None] - candidates[None], axis=-1)
    return candidates[np.sort(_find_medoids(distances, num_points))]


def _find_medoids(distances: np.ndarray, num_medoids: int) -> np.ndarray:
    """Return the indices of medoids, by turns of assignment and update, from points that are far from each other."""
    medoids = _far_apart(distances, num_medoids)
    for _ in range(_MAX_ROUNDS):
        nearest = distances[:, medoids].argmin(axis=1)
        # Of a medoid at the place of another one nothing is left.
        nearest[medoids] = np.arange(num_medoids)
        members = nearest[:, None] == np.arange(num_medoids)
        totals = np.where(members, distances @ members.astype(np.float32), np.inf)
        updated = totals.argmin(axis=0)
        if np.array_equal(updated, medoids):
            break
        medoids = updated
    return medoids


def _far_apart(distances: np.ndarray, count: int) -> np.ndarray:
    """Return the indices of the first point and of those that are each the farthest from all before."""
    chosen = [0]
    gap = distances[0].copy()
    while len(chosen) < count:
        gap[chosen[-1]] = -1
        chosen.append(int(gap.argmax()))
        np.minimum(gap, distances[chosen[-1]], out=gap)
    return np.array(chosen)
