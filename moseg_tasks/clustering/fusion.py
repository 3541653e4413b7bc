"""Affinities of several views: what is unknown is filled in, and kernels become one."""

from collections.abc import Sequence

import numpy as np


def fill_unknown(affinities: Sequence[np.ndarray]) -> np.ndarray:
    """Affinities without NaN, float64 (V, K, K).

    What one view does not know (objects that it never saw together) it takes from the mean of the views that do. What no
    view knows follows the best chain over other objects: the largest product of known affinities, 0 where no chain
    exists. An object of which nothing at all is known joins the background: nothing says that it moves.

    Parameters
    ----------
    affinities : sequence of float64 (K, K)
        In 0..1; NaN where unknown.
    """
    views = np.stack([np.asarray(a, dtype=np.float64) for a in affinities])
    known = np.isfinite(views)
    mean = np.where(known, views, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    missing = ~known.any(axis=0)
    if missing.any():
        lone = missing.all(axis=0)
        mean[lone, 0] = mean[0, lone] = 1.0
        mean[np.diag_indices_from(mean)] = np.where(np.diag(missing), 1.0, np.diag(mean))
        missing &= ~(lone[:, None] | lone[None, :])
        mean = np.where(missing | lone[:, None] | lone[None, :], best_chain(mean), mean)
    return np.where(known, views, mean)


def best_chain(affinity: np.ndarray) -> np.ndarray:
    """Largest product of affinities along any path between two objects, float64 (K, K)."""
    chained = affinity.copy()
    for middle in range(len(chained)):
        np.maximum(chained, chained[:, middle, None] * chained[None, middle, :], out=chained)
    return chained


def fuse_kernels(views: np.ndarray, fusion: str) -> np.ndarray:
    """One kernel (K, K) of all views (V, K, K): their product where `fusion` is "product", else their mean."""
    return views.prod(axis=0) if fusion == "product" else views.mean(axis=0)
