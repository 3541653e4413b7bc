"""The number of motions of minimal description length: a likelihood and a penalty on its parameters."""

import math
from collections.abc import Sequence

import numpy as np

from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.tasks.clustering.epipolar_distances import EpipolarDistances, MotionDistances
from moseg.tasks.clustering.motion_tracks import MotionTracks

_FUNDAMENTAL_DOF, _HOMOGRAPHY_DOF, _AFFINE_DOF = 7, 8, 4
_FIRST_INLIERS, _FIRST_NOISE = 0.7, 0.2
"""Start of the alternation: share of inliers, and noise, px."""
_NUM_ROUNDS = 15
"""After ten, the description length changes by less than a nat."""


def description_lengths(
    labelings: Sequence[np.ndarray],
    tracks: Sequence[MotionTracks],
    params: MotionCountParams,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return the description length of the tracks under each labeling int (K,), nats, float64 (len(labelings),).

    Every motion has its own epipolar geometry in every frame pair, a fundamental matrix or, of fewer parameters, an
    affine one: the one that describes its observations in fewer nats, or none; in pairs without parallax a homography.
    An observation is an inlier with Gaussian noise or a uniformly distributed outlier. Noise and share of outliers are
    those that describe the labeling best and are the same for all its motions. The penalty on a parameter is half the
    logarithm of the number of observations, as in the Bayesian information criterion.

    With this penalty, the required gain of a motion depends on the gain that is possible by chance. A cost with a fixed
    penalty that suits five hundred tracks splits groups of a hundred and merges movers of twenty tracks.

    Parameters
    ----------
    labelings : sequence of int (K,)
    tracks : sequence of MotionTracks
    params : MotionCountParams
        `COUNT_READS` lists the parameters that are read.
    rng : numpy.random.Generator

    References
    ----------
    G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6, 1978; P. Torr, "Bayesian model estimation
    and selection for epipolar geometry and generic manifold fitting", IJCV 50, 2002 (the mixture, and the competition
    of models).
    """
    distances = EpipolarDistances(tracks, len(labelings[0]), params, rng)
    return np.array([description_length(distances.of(labels), params) for labels in labelings])


def description_length(distances: MotionDistances, params: MotionCountParams) -> float:
    """Return the nats of the observations and of the parameters of their motions; 0 without observations."""
    num = len(distances.fit)
    if num == 0:
        return 0.0
    num_fits = int(distances.fit.max()) + 1

    def of_fits(values: np.ndarray) -> np.ndarray:
        return np.bincount(distances.fit, values, num_fits)

    squared = np.stack([distances.full, distances.affine]) ** 2
    # A distance is infinite for all observations of a fit or for none.
    unfitted = np.stack([of_fits(np.isinf(row)) > 0 for row in squared])
    squared = np.where(np.isfinite(squared), squared, 0.0)
    # A homography maps a point to a point, an epipolar geometry to a line.
    codimension = np.where(distances.is_flat, 2, 1)
    is_flat = of_fits(distances.is_flat) > 0
    dof = np.stack([np.where(is_flat, _HOMOGRAPHY_DOF, _FUNDAMENTAL_DOF), np.full(num_fits, _AFFINE_DOF)])
    penalty = params.parameter_price * math.log(num)
    inliers, variance = _FIRST_INLIERS, _FIRST_NOISE**2
    for _ in range(_NUM_ROUNDS):
        log_inlier = math.log(inliers) - (codimension * math.log(2 * math.pi * variance) + squared / variance) / 2
        log_outlier = math.log(1 - inliers) - codimension * math.log(2 * params.outlier_range)
        log_density = np.logaddexp(log_inlier, log_outlier)
        modelled = penalty * dof - np.stack([of_fits(row) for row in log_density])
        nats = np.vstack([np.where(unfitted, np.inf, modelled), -of_fits(log_outlier)])
        choice = nats.argmin(axis=0)[distances.fit]
        model = np.minimum(choice, 1)[None]
        chosen = np.take_along_axis(squared, model, axis=0)[0]
        odds = np.take_along_axis(log_inlier - log_density, model, axis=0)[0]
        weight = np.where(choice < 2, np.exp(odds), 0.0)
        inliers = float(np.clip(weight.mean(), 0.01, 0.99))
        variance = max(float(weight @ chosen / max(weight @ codimension, 1.0)), params.least_noise**2)
    return float(nats.min(axis=0).sum())
