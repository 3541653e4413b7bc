"""Outliers: trajectories that share their preferred hypotheses with hardly any other."""

import numpy as np

from moseg.schemas.parameters import OutlierParams

_DISTANCE_POWER = 0.25
_LEAST_DISTANCE = 1e-2
"""px: differences between smaller distances are rounding of the points."""


def find_outliers(kernel: np.ndarray, distances: np.ndarray, params: OutlierParams) -> np.ndarray:
    """Return the trajectories that are far less like their nearest neighbours than most are: bool (N,).

    A trajectory that follows no motion, such as one that has slipped from its point, prefers hypotheses by chance. In
    a clustering, such trajectories together would take a motion of their own, and one of the true motions would be
    lost. Affinities within a motion vary with its size and with the noise, but by much less. Trajectories far from all
    hypotheses may agree on the wildest ones: their affinities count less, by the fourth root of the distance.

    Parameters
    ----------
    kernel : floating (N, N)
        Affinities of all models together.
    distances : floating (N,)
        To the nearest hypotheses of the most general model, px; NaN if not known.
    params : OutlierParams
    """
    num_tracks = len(kernel)
    if num_tracks <= params.num_neighbours + 1:
        return np.zeros(num_tracks, bool)
    nearest = _nearest_affinities(kernel, params.num_neighbours)
    # Up to half of all may be outliers: the quartiles are then the medians of the others.
    is_known = np.isfinite(distances)
    usual = max(float(np.quantile(distances[is_known], 0.25)), _LEAST_DISTANCE) if is_known.any() else 1.0
    far = np.where(is_known, np.maximum(distances, usual) / usual, 1.0)
    return nearest / far**_DISTANCE_POWER < params.min_affinity * np.quantile(nearest, 0.75)


def join_outliers(
    kernel: np.ndarray, is_outlier: np.ndarray, motion: np.ndarray, distances: np.ndarray, params: OutlierParams
) -> np.ndarray:
    """Assign each outlier to the group that its nearest neighbours in the kernel and its path over all frames suggest.

    The affinities of an outlier are small and may be accidental, so that they are compared after adding a share
    `params.affinity_floor` of the usual. The root of the distance from a group's subspace divides the sum: a track that
    has slipped for some frames is far from all groups, but nearest to its own.

    Parameters
    ----------
    kernel : floating (N, N)
    is_outlier : bool (N,)
    motion : int (M,)
        Group of each trajectory that is no outlier, 0 .. K - 1, each in use.
    distances : float (N, K)
        `subspace_distances` of all trajectories, 1 or more; NaN where not known.
    params : OutlierParams

    Returns
    -------
    (N,)
        Of the dtype of `motion`.
    """
    joined = np.empty(len(kernel), motion.dtype)
    joined[~is_outlier] = motion
    if not is_outlier.any():
        return joined
    affinities, count = kernel[np.ix_(is_outlier, ~is_outlier)], params.num_neighbours
    likeness = []
    for group in range(int(motion.max()) + 1):
        own = np.sort(affinities[:, motion == group], axis=1)[:, -count:]
        # A small group has fewer neighbours to offer.
        likeness.append(own.sum(axis=1) / count)
    usual = np.quantile(_nearest_affinities(kernel, count), 0.75) if len(kernel) > count + 1 else 1.0
    # Affinities alone decide if the distance from a group is not known.
    known = np.isfinite(distances).all(axis=1, keepdims=True)
    far = np.sqrt(np.where(known, distances, 1.0)[is_outlier])
    joined[is_outlier] = np.argmax((np.transpose(likeness) + params.affinity_floor * usual) / far, axis=1)
    return joined


def _nearest_affinities(kernel: np.ndarray, count: int) -> np.ndarray:
    """Return the mean affinity of each trajectory to its nearest others: float (N,)."""
    others = kernel.copy()
    np.fill_diagonal(others, 0)
    return np.partition(others, len(kernel) - count, axis=1)[:, -count:].mean(axis=1)
