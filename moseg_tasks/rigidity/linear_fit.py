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
    refined : number of pairs, those of least loss, that are refined.
    iterations : rounds of iteratively reweighted least squares of each.
    points : least number of tracks within the tolerance of the result.
    share : share of the tracks above which the result counts.
    """

    samples: int
    refined: int
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
    """Fit the two parameters on which most tracks agree, by locally optimised RANSAC.

    Pairs of tracks are drawn; those of least truncated squared error (Torr and Zisserman, "MLESAC", CVIU 2000) are
    refined by least squares with Tukey's biweight, and the refined fit of least error is taken (after Chum, Matas and
    Kittler, "Locally optimized RANSAC", DAGM 2003). Few pairs are enough, because many of them are refined to the same
    fit.

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
    # Tracks that deviate by the tolerance still belong to what is uneven.
    terms, targets, cutoff = design * weights[:, None], values * weights, 2 * tolerance
    agreement = np.where(is_allowed(drawn), _agreement(terms, targets, cutoff, drawn), 0)
    refined = drawn[np.argsort(-agreement, kind="stable")[: limits.refined]]
    for _ in range(limits.iterations):
        refined = _reweighted_least_squares(terms, targets, cutoff, refined)
    agreement = np.where(is_allowed(refined), _agreement(terms, targets, cutoff, refined), 0)
    best = np.argmax(agreement)
    agree = np.abs(terms @ refined[best] - targets) < tolerance
    is_found = agreement[best] > 0 and np.count_nonzero(agree) >= limits.points and np.mean(agree) > limits.share
    return refined[best] if is_found else None


def _residuals(terms: np.ndarray, targets: np.ndarray, cutoff: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """Return the residuals (N, K) of tracks under parameters (K, 2), in cutoffs."""
    return (terms @ parameters.T - targets[:, None]) / cutoff[:, None]


def _agreement(terms: np.ndarray, targets: np.ndarray, cutoff: np.ndarray, parameters: np.ndarray) -> np.ndarray:
    """Return how far tracks agree with parameters (K, 2): the sum (K,) of 1 less the truncated squared residual."""
    return np.clip(1 - _residuals(terms, targets, cutoff, parameters) ** 2, 0, None).sum(axis=0)


def _reweighted_least_squares(
    terms: np.ndarray, targets: np.ndarray, cutoff: np.ndarray, parameters: np.ndarray
) -> np.ndarray:
    """Return the parameters (K, 2) of least squares, each weighted by Tukey's biweight of its own residuals."""
    weights = tukey_weight(_residuals(terms, targets, cutoff, parameters), 1.0)
    products = np.einsum("ni,nj->nij", terms, terms).reshape(-1, 4)
    normal = (weights.T @ products).reshape(-1, 2, 2)
    right = weights.T @ (terms * targets[:, None])
    return (np.linalg.pinv(normal, hermitian=True) @ right[..., None])[..., 0]
