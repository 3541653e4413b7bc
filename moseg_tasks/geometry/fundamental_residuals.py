"""How well each object's two-view model explains every object's tracked points."""

import numpy as np

from moseg_tasks.geometry.fit_fundamentals import HOMOGRAPHY_MODEL, NO_MODEL, FundamentalFits, check_tracks
from moseg_tasks.geometry.homography import homography_sampson_squared
from moseg_tasks.geometry.sampson import sampson_squared
from schemas.parameters import FundamentalParams


def fundamental_residuals(
    fits: FundamentalFits, points0: np.ndarray, points1: np.ndarray, object: np.ndarray, params: FundamentalParams
) -> np.ndarray:
    """Squared Sampson distance of each object's points to each object's model.

    Parameters
    ----------
    fits : FundamentalFits
        K objects.
    points0, points1 : float (N, 2)
        xy of the tracks visible in both frames of a pair, px.
    object : uint16 (N,)
        Object of each track.
    params : FundamentalParams
        `statistic` and `min_points` are read.

    Returns
    -------
    residual : float64 (K, K)
        [model, data], px^2: the median or mean over the data object's points. NaN where the model is not valid or the
        data object has fewer than `min_points` points.

    Raises
    ------
    InputError
        Where the arrays disagree in length or an object is out of range.
    """
    num_objects = len(fits.F)
    check_tracks(points0, points1, object, num_objects)
    points0, points1 = points0.astype(np.float64), points1.astype(np.float64)
    reduce = np.median if params.statistic == "median" else np.mean
    residual = np.full((num_objects, num_objects), np.nan)
    for data in range(num_objects):
        own = object == data
        if own.sum() < params.min_points:
            continue
        for distance_squared, used in (
            (sampson_squared, (fits.kind != NO_MODEL) & (fits.kind != HOMOGRAPHY_MODEL)),
            (homography_sampson_squared, fits.kind == HOMOGRAPHY_MODEL),
        ):
            residual[used, data] = reduce(distance_squared(fits.F[used], points0[own], points1[own]), axis=-1)
    return residual
