"""Affinity from the size of residuals: two objects are alike when one's model predicts the other."""

import warnings

import numpy as np

from schemas.parameters import AffinityParams

_COMBINE = {"min": np.fmin, "max": np.fmax, "mean": lambda a, b: np.nanmean(np.stack([a, b]), axis=0)}


def residual_affinity(residuals: np.ndarray, params: AffinityParams) -> np.ndarray:
    """Affinity ``exp(-d² / 2)`` of a distance d between motions, in units of the tolerated error.

    With r the mean squared error of j's data under i's model, ``d_ij² = (r_ij - r_jj) / (scale² + relative² r_jj)``:
    what j's own model leaves as well is noise, not another motion. The two directions are combined, then the median over
    frame pairs is taken. Unlike a rank, d has a scale: a motion that owns a single object is like no other.

    Parameters
    ----------
    residuals : float64 (M, K, K)
        [pair, model, data], px²; NaN where the model is invalid or the object absent.
    params : AffinityParams

    Returns
    -------
    float64 (K, K)
        In 0..1, symmetric, 1 on the diagonal; NaN for objects that share no pair (the diagonal included).
    """
    distances = motion_distances(residuals, params)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="All-NaN slice")
        distance = np.nanquantile(distances, params.quantile, axis=0) if len(distances) else distances.sum(axis=0) * np.nan
    return np.exp(-0.5 * distance**2)


def motion_distances(residuals: np.ndarray, params: AffinityParams) -> np.ndarray:
    """Symmetric distance d of each two objects in each frame pair, float64 (M, K, K); NaN where unknown."""
    own = np.diagonal(residuals, axis1=1, axis2=2)[:, None, :]
    excess = np.maximum(residuals - own, 0.0) if params.excess else residuals
    directed = np.sqrt(excess / (params.scale**2 + params.relative**2 * own))
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Mean of empty slice")
        distances = _COMBINE[params.direction](directed, directed.transpose(0, 2, 1))
    index = np.arange(residuals.shape[1])
    distances[:, index, index] = np.where(np.isfinite(own[:, 0]), 0.0, np.nan)
    return distances
