"""Fusion of the affinities of several views, and completion of their unknown values."""

from collections.abc import Sequence

import numpy as np


def unit_diagonal(affinity: np.ndarray) -> np.ndarray:
    """Normalise an affinity to ``a_ij / sqrt(a_ii a_jj)``, so that ranks, which have no scale, are in 0..1 as well."""
    diagonal = np.diag(affinity)
    root = np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    return np.where(np.isfinite(affinity), affinity / (root[:, None] * root[None, :]), np.nan)


def fill_unknown(affinities: Sequence[np.ndarray]) -> np.ndarray:
    """Return the affinities without NaN, float64 (V, K, K).

    A value unknown in one view (two objects never visible together) is the mean of the views that have it. A value
    unknown in all views is that of the best chain over other objects: the largest product of known affinities, 0 if
    there is no chain. An object without any known affinity joins the background: there is no evidence that it moves.

    Parameters
    ----------
    affinities : sequence of float64 (K, K)
        In 0..1; NaN if unknown.
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
    """Return the largest product of affinities along any path between two objects, float64 (K, K)."""
    chained = affinity.copy()
    for middle in range(len(chained)):
        chained = np.maximum(chained, chained[:, middle, None] * chained[None, middle, :])
    return chained


def fuse_kernels(views: np.ndarray, fusion: str) -> np.ndarray:
    """Fuse all views (V, K, K) into one kernel (K, K).

    ``product`` is their geometric mean: it averages the exponents, so that a view that separates two motions clearly
    outweighs one that does not, and the scale is the same for any number of views. ``sum`` is the arithmetic mean.
    """
    return views.prod(axis=0) ** (1.0 / len(views)) if fusion == "product" else views.mean(axis=0)
