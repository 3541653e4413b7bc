"""Support of a motion model for an object being part of the static background."""

import numpy as np

from moseg.schemas.parameters import AffinityParams
from moseg.tasks.affinity.quantiles import known_quantile
from moseg.tasks.affinity.residual import kernel, tolerated_error


def static_support(residuals: np.ndarray, params: AffinityParams, energy: np.ndarray | None = None) -> np.ndarray:
    """Return the affinity ``exp(-d² / 2)`` of each object to the background, also valid for a bad background fit.

    With r_0j the mean squared error of object j under the background's model,
    ``d² = (r_0j - r_jj) / (scale² + relative² r_jj + relative_flow² e_j)``. The affinity between two objects also adds
    the background's residual under its own model to the denominator: if that model fits badly, there is no evidence
    that the object moves. But there is no evidence either that it is static. Here a badly fitting background gives a
    large d, so that such a view does not support static.

    An object that rests most of the time is still one that moves: d is the largest quantile over runs of
    `static_pairs` frame pairs.

    Parameters
    ----------
    residuals : float64 (M, K, K)
        [pair, model, data], px²; NaN if the model is invalid or the object absent. Object 0 is the background.
    params : AffinityParams
        `scale`, `relative`, `relative_flow`, `excess`, `quantile` and `static_pairs` are read.
    energy : float64 (M, K), optional
        Mean squared flow length of each object, px²; None if the residuals are not of flow.

    Returns
    -------
    float64 (K,)
        In 0..1; 1 for the background; NaN, which is no support, for an object never visible together with it.
    """
    own = np.diagonal(residuals, axis1=1, axis2=2)
    under_background = residuals[:, 0, :]
    excess = np.maximum(under_background - own, 0.0) if params.excess else under_background
    distances = np.sqrt(excess / tolerated_error(own, params, energy))
    support = np.full(residuals.shape[1], np.nan)
    if len(distances) > 0:
        support = kernel(_largest_in_a_row(distances, params))
    support[0] = 1.0
    return support


def _largest_in_a_row(distances: np.ndarray, params: AffinityParams) -> np.ndarray:
    """Return the largest quantile (K,) of the distances (M, K) over runs of pairs of which half are known.

    That over all pairs counts too. Runs overlap by half, the last one by more, so that every pair is in one.
    """
    length, step = params.static_pairs, params.static_pairs // 2
    largest = known_quantile(distances, params.quantile)
    last = len(distances) - length
    for start in [*range(0, last, step), last] if last >= 0 else []:
        run = distances[start : start + length]
        is_known = np.isfinite(run).sum(axis=0) > length // 2
        largest = np.where(is_known, np.fmax(largest, known_quantile(run, params.quantile)), largest)
    return largest
