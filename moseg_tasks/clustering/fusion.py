"""Affinities of several views: what is unknown is filled in, and kernels become one."""

from collections.abc import Sequence

import numpy as np


def unit_diagonal(affinity: np.ndarray) -> np.ndarray:
    """Cosine-normalised affinity ``a_ij / sqrt(a_ii a_jj)``: ranks, which have no scale, come to 0..1 as well."""
    diagonal = np.diag(affinity)
    root = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    return np.where(np.isfinite(affinity), affinity / (root[:, None] * root[None, :]), np.nan)


def fill_unknown(affinities: Sequence[np.ndarray]) -> np.ndarray:
    """Affinities without NaN, float64 (V, K, K).

    What one view does not know (objects that it never saw together) it takes from the mean of the views that do. What
    no view knows follows the best chain over other objects: the largest product of known affinities, 0 where no chain
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
        lone = (missing | np.eye(len(mean), dtype=bool)).all(axis=0)
        mean[lone, 0] = mean[0, lone] = 1.0
        np.fill_diagonal(mean, np.where(np.diag(missing), 1.0, np.diag(mean)))
        chained = best_chain(mean)
        mean = np.where(missing, chained, mean)
    return np.where(known, views, mean)


def best_chain(affinity: np.ndarray) -> np.ndarray:
    """Largest product of affinities along any path between two objects, float64 (K, K)."""
    chained = affinity.copy()
    for middle in range(len(chained)):
        chained = np.maximum(chained, chained[:, middle, None] * chained[None, middle, :])
    return chained


def fuse_kernels(views: np.ndarray, fusion: str) -> np.ndarray:
    """One kernel (K, K) of all views (V, K, K).

    ``product`` is their geometric mean: it averages the exponents, so that a view which clearly sees two motions
    outweighs one that is blind to their difference, and one scale holds for any number of views. ``sum`` is the mean.
    """
    return views.prod(axis=0) ** (1.0 / len(views)) if fusion == "product" else views.mean(axis=0)
