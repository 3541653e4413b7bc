"""Fits of a two-view model to each object's tracked points."""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import FundamentalParams
from moseg.tasks.geometry.coordinates import normalise_points, normalising_transform, pixel_scale
from moseg.tasks.geometry.degeneracy import Degeneracy, find_degeneracy, point_spread
from moseg.tasks.geometry.poselib_fundamental import poselib_fundamental
from moseg.tasks.geometry.ransac import FUNDAMENTAL, HOMOGRAPHY, RobustFit, ransac


class ModelKind(IntEnum):
    """Kind of the 3 x 3 matrix of an object, stored as uint8."""

    NONE = 0
    FUNDAMENTAL = 1
    HOMOGRAPHY = 2


class FundamentalFits(NamedTuple):
    """The two-view model of each object of a frame pair.

    Attributes
    ----------
    F : float64 (K, 3, 3)
        In pixel coordinates, unit Frobenius norm, entry of largest magnitude positive; 0 if not valid.
    valid : bool (K,)
        Whether the model is used.
    counts : int32 (K, 3)
        Points visible in both frames, inliers of the fundamental matrix, inliers of the best homography.
    reason : uint8 (K,)
        `Degeneracy` of the fundamental matrix, also where it is kept or replaced.
    kind : uint8 (K,)
        `ModelKind` of `F`.
    """

    F: np.ndarray
    valid: np.ndarray
    counts: np.ndarray
    reason: np.ndarray
    kind: np.ndarray


class _Candidate(NamedTuple):
    """Models fitted to one object, in normalised coordinates; None for a model that was not found."""

    fundamental: np.ndarray | None
    homography: np.ndarray | None
    reason: Degeneracy
    counts: tuple[int, int, int]
    spread: float


def fit_fundamentals(
    points0: np.ndarray,
    points1: np.ndarray,
    object: np.ndarray,
    num_objects: int,
    params: FundamentalParams,
    rng: np.random.Generator,
    image_shape: tuple[int, int],
) -> FundamentalFits:
    """Fit each object's fundamental matrix and test whether its points determine it.

    `params.degenerate` defines the treatment of a degenerate fit. With "homography" the fit is kept, but a homography
    replaces it if the scene shows no parallax: with a still or rotating camera, or a plane, the fundamental matrix is
    arbitrary, and an arbitrary one explains many moving points. The object whose points spread widest, usually the
    background, decides whether there is parallax: a shallow object fits a homography in every scene, and its
    extrapolated homography would separate it from a background that has parallax.

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
        Each object draws from its own child generator, so its fit does not depend on the other objects' points.
    image_shape : (int, int)
        Height and width, px.

    Returns
    -------
    FundamentalFits

    Raises
    ------
    InputError
        If the arrays disagree in length or an object is out of range.
    """
    check_tracks(points0, points1, object, num_objects)
    normalised0 = normalise_points(points0, image_shape)
    normalised1 = normalise_points(points1, image_shape)
    scale = pixel_scale(image_shape)
    candidates = [
        _fit_object(normalised0[object == index], normalised1[object == index], params, object_rng, scale)
        for index, object_rng in enumerate(rng.spawn(num_objects))
    ]
    kinds = _choose_models(candidates, params)
    T = normalising_transform(image_shape)
    F = np.zeros((num_objects, 3, 3))
    for index, (candidate, kind) in enumerate(zip(candidates, kinds, strict=True)):
        if kind == ModelKind.FUNDAMENTAL:
            F[index] = _fix_gauge(T.T @ candidate.fundamental @ T)
        elif kind == ModelKind.HOMOGRAPHY:
            F[index] = _fix_gauge(np.linalg.inv(T) @ candidate.homography @ T)
    return FundamentalFits(
        F=F,
        valid=np.array([kind != ModelKind.NONE for kind in kinds], dtype=bool),
        counts=np.array([candidate.counts for candidate in candidates], dtype=np.int32).reshape(-1, 3),
        reason=np.array([candidate.reason for candidate in candidates], dtype=np.uint8),
        kind=np.array(kinds, dtype=np.uint8),
    )


def check_tracks(points0: np.ndarray, points1: np.ndarray, object: np.ndarray, num_objects: int) -> None:
    """Raise InputError if the tracks of a frame pair are inconsistent."""
    shape = (len(object), 2)
    for name, points in (("points0", points0), ("points1", points1)):
        if points.shape != shape:
            raise InputError("wrong shape of tracks", where=name, got=points.shape, expected=shape)
    if len(object) and object.max() >= num_objects:
        raise InputError("object out of range", where="object", got=object.max(), expected=f"below {num_objects}")


def _fit_object(
    points0: np.ndarray, points1: np.ndarray, params: FundamentalParams, rng: np.random.Generator, scale: float
) -> _Candidate:
    """Fit both models of one object in normalised coordinates; `scale` is px per unit."""
    num_points = len(points0)
    if num_points < params.min_points:
        return _Candidate(None, None, Degeneracy.TOO_FEW_POINTS, (num_points, 0, 0), 0.0)
    search = {"threshold": params.threshold / scale, "num_samples": params.num_samples, "rng": rng}
    fundamental: RobustFit | None
    if params.estimator == "poselib":
        fundamental = poselib_fundamental(points0, points1, **search)
    else:
        fundamental = ransac(FUNDAMENTAL, points0, points1, num_refits=params.num_refits, **search)
    homography = ransac(HOMOGRAPHY, points0, points1, num_refits=params.num_refits, **search)
    num_homography = int(homography.inlier_mask.sum())
    if fundamental is None:
        reason, num_fundamental = Degeneracy.NO_MODEL, 0
    else:
        num_fundamental = int(fundamental.inlier_mask.sum())
        reason = find_degeneracy(points0, points1, fundamental.inlier_mask, num_homography, params, scale)
    return _Candidate(
        None if fundamental is None else fundamental.matrix,
        homography.matrix,
        reason,
        (num_points, num_fundamental, num_homography),
        point_spread(points0),
    )


def _choose_models(candidates: list[_Candidate], params: FundamentalParams) -> list[ModelKind]:
    """Choose one of the two models for each object."""
    has_parallax = True
    if params.degenerate == "homography" and candidates:
        widest = max(candidates, key=lambda candidate: candidate.spread)
        has_parallax = widest.reason != Degeneracy.HOMOGRAPHY
    kinds = []
    for candidate in candidates:
        if candidate.reason == Degeneracy.HOMOGRAPHY and not has_parallax:
            kinds.append(ModelKind.HOMOGRAPHY)
        elif candidate.fundamental is None:
            kinds.append(ModelKind.NONE)
        elif candidate.reason == Degeneracy.NONE or params.degenerate != "discard":
            kinds.append(ModelKind.FUNDAMENTAL)
        else:
            kinds.append(ModelKind.NONE)
    return kinds


def _fix_gauge(matrix: np.ndarray) -> np.ndarray:
    """Scale a projective matrix to unit Frobenius norm and a positive entry of largest magnitude."""
    largest = matrix.flat[np.argmax(np.abs(matrix))]
    return matrix * (np.sign(largest) / np.linalg.norm(matrix))
