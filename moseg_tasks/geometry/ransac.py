"""Seeded RANSAC over batched minimal samples, with local refits on the inliers."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from moseg.tasks.geometry import eight_point, homography
from moseg.tasks.geometry.sampson import sampson_squared


class ModelFamily(NamedTuple):
    """Solver and error metric of a two-view model, for RANSAC."""

    sample_size: int
    solve: Callable[[np.ndarray, np.ndarray], np.ndarray]
    distance_squared: Callable[[np.ndarray, np.ndarray, np.ndarray], np.ndarray]


FUNDAMENTAL = ModelFamily(eight_point.SAMPLE_SIZE, eight_point.eight_point, sampson_squared)
HOMOGRAPHY = ModelFamily(homography.SAMPLE_SIZE, homography.homography_dlt, homography.homography_sampson_squared)


class RobustFit(NamedTuple):
    """A model and its inliers."""

    matrix: np.ndarray
    """float64 (3, 3)"""
    inlier_mask: np.ndarray
    """bool (N,)"""


def ransac(
    family: ModelFamily,
    points0: np.ndarray,
    points1: np.ndarray,
    *,
    threshold: float,
    num_samples: int,
    num_refits: int,
    rng: np.random.Generator,
) -> RobustFit:
    """Return the model of smallest truncated squared distance over random minimal samples, refitted to its inliers.

    All samples are solved at once; there is no early stop, so the time and the random stream depend only on the number
    of points.

    Parameters
    ----------
    family : ModelFamily
        FUNDAMENTAL or HOMOGRAPHY.
    points0, points1 : float64 (N, 2)
        Matching points, N >= family.sample_size.
    threshold : float
        Sampson distance of an inlier, in the unit of the points.
    num_samples : int
        Number of minimal samples.
    num_refits : int
        Most least-squares refits to the inliers; they end when the cost no longer falls.
    rng : numpy.random.Generator

    Returns
    -------
    RobustFit

    References
    ----------
    P. Torr and A. Zisserman, MLESAC, CVIU 2000 (the truncated cost, MSAC);
    O. Chum, J. Matas and J. Kittler, Locally optimized RANSAC, DAGM 2003.
    """
    limit = threshold**2
    samples = draw_samples(len(points0), family.sample_size, num_samples, rng)
    models = family.solve(points0[samples], points1[samples])
    distances = family.distance_squared(models, points0, points1)
    costs = np.minimum(distances, limit).sum(axis=-1)
    best = int(np.argmin(costs))
    model, distance, cost = models[best], distances[best], costs[best]
    for _ in range(num_refits):
        inlier_mask = distance < limit
        if inlier_mask.sum() < family.sample_size:
            break
        refit = family.solve(points0[inlier_mask], points1[inlier_mask])
        refit_distance = family.distance_squared(refit[None], points0, points1)[0]
        refit_cost = np.minimum(refit_distance, limit).sum()
        if refit_cost >= cost:
            break
        model, distance, cost = refit, refit_distance, refit_cost
    return RobustFit(model, distance < limit)


def draw_samples(num_points: int, sample_size: int, num_samples: int, rng: np.random.Generator) -> np.ndarray:
    """Draw the indices of random samples, without repetition inside a sample: intp (num_samples, sample_size)."""
    keys = rng.random((num_samples, num_points))
    return np.argpartition(keys, sample_size - 1, axis=1)[:, :sample_size]
