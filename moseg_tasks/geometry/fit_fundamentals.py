"""A two-view model for each object's tracked points."""

from typing import NamedTuple

import numpy as np

from moseg_tasks.geometry.coordinates import normalise_points, normalising_transform, pixel_scale
from moseg_tasks.geometry.degeneracy import Degeneracy, epipolar_conditioning, line_distance
from moseg_tasks.geometry.poselib_fundamental import poselib_fundamental
from moseg_tasks.geometry.ransac import FUNDAMENTAL, HOMOGRAPHY, RobustFit, ransac
from schemas.errors import InputError
from schemas.parameters import FundamentalParams

NO_MODEL, FUNDAMENTAL_MODEL, HOMOGRAPHY_MODEL = 0, 1, 2


class FundamentalFits(NamedTuple):
    """The two-view model of each object of a frame pair.

    Attributes
    ----------
    F : float64 (K, 3, 3)
        In pixel coordinates, unit Frobenius norm, entry of largest magnitude positive; 0 where not valid.
    valid : bool (K,)
        Whether the model is to be used.
    counts : int32 (K, 3)
        Points visible in both frames, inliers of the fundamental matrix, inliers of the best homography.
    reason : uint8 (K,)
        `Degeneracy` of the fundamental matrix, also where it is kept or replaced.
    kind : uint8 (K,)
        0 no model, 1 `F` is a fundamental matrix, 2 `F` is a homography.
    """

    F: np.ndarray
    valid: np.ndarray
    counts: np.ndarray
    reason: np.ndarray
    kind: np.ndarray


def fit_fundamentals(
    points0: np.ndarray,
    points1: np.ndarray,
    object: np.ndarray,
    num_objects: int,
    params: FundamentalParams,
    rng: np.random.Generator,
    image_shape: tuple[int, int],
) -> FundamentalFits:
    """Fit each object's fundamental matrix and say whether its points determine it.

    Parameters
    ----------
    points0, points1 : float (N, 2)
        xy of the tracks visible in both frames of a pair, px.
    object : uint16 (N,)
        Object of each track, below `num_objects`.
    num_objects : int
        K.
    params : FundamentalParams
    rng : numpy.random.Generator
        Each object draws from a child of its own, so its fit does not depend on the other objects' points.
    image_shape : (int, int)
        Height and width, px.

    Returns
    -------
    FundamentalFits

    Raises
    ------
    InputError
        Where the arrays disagree in length or an object is out of range.
    """
    check_tracks(points0, points1, object, num_objects)
    fits = FundamentalFits(
        F=np.zeros((num_objects, 3, 3)),
        valid=np.zeros(num_objects, dtype=bool),
        counts=np.zeros((num_objects, 3), dtype=np.int32),
        reason=np.zeros(num_objects, dtype=np.uint8),
        kind=np.zeros(num_objects, dtype=np.uint8),
    )
    normalised0 = normalise_points(points0, image_shape)
    normalised1 = normalise_points(points1, image_shape)
    T = normalising_transform(image_shape)
    for index, object_rng in enumerate(rng.spawn(num_objects)):
        own = object == index
        fit = _fit_object(normalised0[own], normalised1[own], params, object_rng, pixel_scale(image_shape))
        fits.counts[index] = fit.counts
        fits.reason[index] = fit.reason
        fits.kind[index] = fit.kind
        fits.valid[index] = fit.kind != NO_MODEL
        if fit.kind == FUNDAMENTAL_MODEL:
            fits.F[index] = fix_gauge(T.T @ fit.matrix @ T)
        elif fit.kind == HOMOGRAPHY_MODEL:
            fits.F[index] = fix_gauge(np.linalg.inv(T) @ fit.matrix @ T)
    return fits


def check_tracks(points0: np.ndarray, points1: np.ndarray, object: np.ndarray, num_objects: int) -> None:
    """Raise InputError where the tracks of a frame pair are inconsistent."""
    shape = (len(object), 2)
    for name, points in (("points0", points0), ("points1", points1)):
        if points.shape != shape:
            raise InputError("wrong shape of tracks", where=name, got=points.shape, expected=shape)
    if len(object) and object.max() >= num_objects:
        raise InputError("object out of range", where="object", got=object.max(), expected=f"below {num_objects}")


def fix_gauge(matrix: np.ndarray) -> np.ndarray:
    """The same projective matrix with unit Frobenius norm and a positive entry of largest magnitude."""
    largest = matrix.flat[np.argmax(np.abs(matrix))]
    return matrix * (np.sign(largest) / np.linalg.norm(matrix))


class _ObjectFit(NamedTuple):
    matrix: np.ndarray | None
    kind: int
    reason: Degeneracy
    counts: tuple[int, int, int]


def _fit_object(
    points0: np.ndarray, points1: np.ndarray, params: FundamentalParams, rng: np.random.Generator, scale: float
) -> _ObjectFit:
    """One object's model in normalised coordinates; `scale` is px per unit."""
    num_points = len(points0)
    if num_points < params.min_points:
        return _ObjectFit(None, NO_MODEL, Degeneracy.TOO_FEW_POINTS, (num_points, 0, 0))
    fundamental = _estimate(points0, points1, params, rng, scale)
    homography = ransac(
        HOMOGRAPHY,
        points0,
        points1,
        threshold=params.threshold / scale,
        num_samples=params.num_samples,
        num_refits=params.num_refits,
        rng=rng,
    )
    num_homography = int(homography.inlier_mask.sum())
    if fundamental is None:
        reason = Degeneracy.NO_MODEL
        counts = (num_points, 0, num_homography)
    else:
        reason = _degeneracy(points0, points1, fundamental.inlier_mask, num_homography, params, scale)
        counts = (num_points, int(fundamental.inlier_mask.sum()), num_homography)
    if params.degenerate == "homography" and reason == Degeneracy.HOMOGRAPHY:
        return _ObjectFit(homography.matrix, HOMOGRAPHY_MODEL, reason, counts)
    if fundamental is not None and (reason == Degeneracy.NONE or params.degenerate == "keep"):
        return _ObjectFit(fundamental.matrix, FUNDAMENTAL_MODEL, reason, counts)
    return _ObjectFit(None, NO_MODEL, reason, counts)


def _estimate(points0, points1, params: FundamentalParams, rng: np.random.Generator, scale: float) -> RobustFit | None:
    threshold = params.threshold / scale
    if params.estimator == "poselib":
        return poselib_fundamental(
            points0, points1, threshold=threshold, num_samples=params.num_samples, rng=rng
        )
    return ransac(
        FUNDAMENTAL,
        points0,
        points1,
        threshold=threshold,
        num_samples=params.num_samples,
        num_refits=params.num_refits,
        rng=rng,
    )


def _degeneracy(points0, points1, inlier_mask, num_homography: int, params: FundamentalParams, scale: float) -> Degeneracy:
    inliers0, inliers1 = points0[inlier_mask], points1[inlier_mask]
    if len(inliers0) < FUNDAMENTAL.sample_size:
        return Degeneracy.NO_MODEL
    if min(line_distance(inliers0), line_distance(inliers1)) * scale < params.collinear_width:
        return Degeneracy.COLLINEAR
    if num_homography >= params.homography_ratio * len(inliers0):
        return Degeneracy.HOMOGRAPHY
    if epipolar_conditioning(inliers0, inliers1) < params.min_conditioning:
        return Degeneracy.ILL_CONDITIONED
    return Degeneracy.NONE
