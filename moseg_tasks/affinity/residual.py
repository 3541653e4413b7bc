"""Affinity from the size of residuals: two objects are alike if the model of one predicts the other."""

import numpy as np

from moseg.schemas.parameters import AffinityParams
from moseg.tasks.affinity.quantiles import known_quantile

_TAIL = 2.0  # distance from which the kernel's exponent grows linearly, so that large distances keep their order


def residual_affinity(residuals: np.ndarray, params: AffinityParams, energy: np.ndarray | None = None) -> np.ndarray:
    """Return the affinity ``exp(-d² / 2)`` of a distance d between motions, in units of the tolerated error.

    Unlike a rank, d has a scale: a motion with a single object has no affinity to others. Beyond d = 2 the exponent
    grows linearly (Huber's function); the square would underflow and make all distant objects equally distant.

    Parameters
    ----------
    residuals : float64 (M, K, K)
        [pair, model, data], px²; NaN if the model is invalid or the object absent. Object 0 is the background.
    params : AffinityParams
    energy : float64 (M, K), optional
        Mean squared flow length of each object, px²; None if the residuals are not of flow.

    Returns
    -------
    float64 (K, K)
        In 0..1, symmetric, 1 on the diagonal; NaN for objects that share no pair (the diagonal included).
    """
    distances = motion_distances(residuals, params, energy)
    if len(distances) == 0:
        return np.full(residuals.shape[1:], np.nan)
    return kernel(known_quantile(distances, params.quantile))


def kernel(distance: np.ndarray) -> np.ndarray:
    """Return the affinity 0..1 of distances in units of the tolerated error; NaN stays NaN."""
    near = np.minimum(distance, _TAIL)
    return np.exp(-near * (distance - 0.5 * near))


def tolerated_error(own: np.ndarray, params: AffinityParams, energy: np.ndarray | None = None) -> np.ndarray:
    """Return the mean squared error in the prediction of each object's data that one motion may have, px².

    `own` (M, K) are the residuals of the objects' own models; `energy` (M, K) is that of ``residual_affinity``.
    """
    tolerance = params.scale**2 + params.relative**2 * own
    if energy is None:
        return tolerance
    return tolerance + params.relative_flow**2 * np.nan_to_num(energy)


def motion_distances(residuals: np.ndarray, params: AffinityParams, energy: np.ndarray | None = None) -> np.ndarray:
    """Return the symmetric distance d of each two objects in each frame pair, float64 (M, K, K); NaN if unknown.

    With r_ij the mean squared error of j's data under i's model and e_j the energy of j's flow,
    ``d_ij² = (r_ij - r_jj) / (scale² + relative² (r_ii + r_jj) + relative_flow² e_j)``. The residual of j under its own
    model is noise, not another motion; the residual of i under its own model measures the reliability of that model.
    The share of the flow accounts for the models' linearisation, whose error grows with the flow of near objects.

    The parameters of a small object, fitted to few pixels, are not accurate outside it, so the smaller direction
    counts: the larger object's model on the smaller object. The background's model is the more accurate one.
    """
    own = np.diagonal(residuals, axis1=1, axis2=2)
    excess = np.maximum(residuals - own[:, None, :], 0.0) if params.excess else residuals
    model_error = params.relative**2 * np.nan_to_num(own)
    directed = np.sqrt(excess / (tolerated_error(own, params, energy)[:, None, :] + model_error[:, :, None]))
    distances = _combine(directed, params.direction)
    index = np.arange(residuals.shape[1])
    distances[:, index, index] = np.where(np.isfinite(own), 0.0, np.nan)
    return distances


def _combine(directed: np.ndarray, direction: str) -> np.ndarray:
    """Combine both directions, float64 (M, K, K); if one is unknown, return the other."""
    swapped = directed.transpose(0, 2, 1)
    if direction == "max":
        return np.fmax(directed, swapped)
    if direction == "mean":
        return np.where(
            np.isfinite(directed) & np.isfinite(swapped), (directed + swapped) / 2, np.fmin(directed, swapped)
        )
    distances = np.fmin(directed, swapped)
    if direction == "background":
        background = np.where(np.isfinite(directed[:, 0]), directed[:, 0], directed[:, :, 0])
        distances[:, 0, :] = distances[:, :, 0] = background
    return distances
