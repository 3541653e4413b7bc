"""Robust fit of inverse depth as a linear function of two terms, judged by parallax in px."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from moseg.tasks.saliency.background import tukey_weight

_MINIMAL_SAMPLE = 2


class FitLimits(NamedTuple):
    """Effort and success of a fit.

    Attributes
    ----------
    samples : number of pairs of tracks drawn.
    iterations : rounds of iteratively reweighted least squares.
    points : least number of tracks within the tolerance of the best pair.
    share : share of the tracks above which the result counts.
    """

    samples: int
    iterations: int
    points: int
    share: float


def fit_two_parameters(
    design: np.ndarray,
    values: np.ndarray,
    weights: np.ndarray,
    tolerance: np.ndarray,
    is_allowed: Callable[[np.ndarray], np.ndarray],
    limits: FitLimits,
    rng: np.random.Generator,
) -> np.ndarray | None:
    """Fit the two parameters on which most tracks agree, by RANSAC and then Tukey's biweight.

    Parameters
    ----------
    design : float64 (N, 2)
        Terms of each track.
    values : float64 (N,)
        Inverse depths.
    weights : float64 (N,)
        px per inverse depth.
    tolerance : float64 (N,)
        px.
    is_allowed : function
        From parameters (..., 2) to bool (...).
    limits : FitLimits
    rng : numpy.random.Generator

    Returns
    -------
    float64 (2,) or None
        None if too few tracks agree on allowed parameters.
    """
    if len(values) < limits.points:
        return None
    pairs = rng.integers(len(values), size=(limits.samples, _MINIMAL_SAMPLE))
    # Two tracks with proportional terms do not determine both; their pseudo-inverse gives a fit without support.
    drawn = (np.linalg.pinv(design[pairs], rcond=1e-9) @ values[pairs][..., None])[..., 0]
    error = np.abs(design @ drawn.T - values[:, None]) * weights[:, None]
    support = np.where(is_allowed(drawn), np.count_nonzero(error < tolerance[:, None], axis=0), 0)
    best = np.argmax(support)
    if support[best] < limits.points:
        return None
    found = drawn[best]
    for _ in range(limits.iterations):
        # Tracks that deviate by the tolerance still belong to what is uneven.
        root = np.sqrt(tukey_weight((design @ found - values) * weights, 2 * tolerance)) * weights
        found = np.linalg.lstsq(design * root[:, None], values * root, rcond=None)[0]
    share = np.mean(np.abs(design @ found - values) * weights < tolerance)
    return found if share > limits.share and is_allowed(found) else None
