"""Residuals of every object's tracked points under each object's two-view model."""

import numpy as np

from moseg.schemas.parameters import FundamentalParams
from moseg.tasks.geometry.fit import FundamentalFits, ModelKind, check_tracks
from moseg.tasks.geometry.homography import homography_sampson_squared
from moseg.tasks.geometry.sampson import sampson_squared

_DISTANCES = {ModelKind.FUNDAMENTAL: sampson_squared, ModelKind.HOMOGRAPHY: homography_sampson_squared}
_STATISTICS = {"median": np.median, "mean": np.mean}


def fundamental_residuals(
    fits: FundamentalFits, points0: np.ndarray, points1: np.ndarray, object: np.ndarray, params: FundamentalParams
) -> np.ndarray:
    """Return the squared Sampson distance of each object's points to each object's model.

    The paper takes the mean over the points. The median is the default because a mean depends on single mistracked
    points and on a few pixels of background inside a mask.

    Parameters
    ----------
    fits : FundamentalFits
        K objects.
    points0, points1 : float (N, 2)
        xy of the tracks visible in both frames of a pair, px.
    object : uint16 (N,)
        Object of each track, below K.
    params : FundamentalParams
        `statistic` and `min_points` are read.

    Returns
    -------
    residual : float64 (K, K)
        [model, data], px^2. NaN if the model is not valid or the data object has fewer than `min_points` points.

    Raises
    ------
    InputError
        If the arrays disagree in length or an object is out of range.
    """
    num_objects = len(fits.F)
    check_tracks(points0, points1, object, num_objects)
    statistic = _STATISTICS[params.statistic]
    residual = np.full((num_objects, num_objects), np.nan)
    for data in range(num_objects):
        own = object == data
        if own.sum() < params.min_points:
            continue
        own0, own1 = points0[own].astype(np.float64), points1[own].astype(np.float64)
        for kind, distance_squared in _DISTANCES.items():
            models = fits.kind == kind
            residual[models, data] = statistic(distance_squared(fits.F[models], own0, own1), axis=-1)
    return residual
