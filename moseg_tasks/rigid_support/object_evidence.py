"""Evidence of the dense tracks inside and around objects: whether a rigid scene explains them, and where they stand."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from moseg.schemas.parameters import RigidityParams, RigidSupportParams, SceneParallaxParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.explained_shares import share_of_plane
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.tracks.labels_at import labels_at

_MOST_NOISE = 2.0
"""Noise of the inverse depth of others, in its median, up to which they have a depth."""


class ObjectEvidence(NamedTuple):
    """Evidence about K objects, the background included; its values are not meaningful.

    Attributes
    ----------
    num_observations : int64 (K,)
        Tracks that stay in the object over a frame pair, summed over the pairs.
    test : float64 (K,)
        Their mean strict test, -1..3; 0 without observations.
    num_contour : float64 (K,)
        Tracks that have one outside the object near them, in the mean over the pairs in which the object has tracks.
    attached : float64 (K,)
        Share of those that may have the inverse depth of a track outside; 1 without any.
    num_inside : float64 (K,)
        All tracks in the object, in the mean over the same pairs.
    accompanied : float64 (K,)
        Share of all tracks in the object that may have the inverse depth of `RigidSupportParams.min_contour` tracks
        outside of all objects, wherever those are, that the rigid scene explains; 1 without any.
    num_pairs : int
        Frame pairs that were read.
    gain : float
        Share of the tracks outside of all objects that a rigid scene explains and no single plane does: the median over
        the pairs that are farthest apart and have enough of them, 0 without any. It is 0 in a pair in which less than
        half of the tracks that the rigid scene explains are outside.
    """

    num_observations: np.ndarray
    test: np.ndarray
    num_contour: np.ndarray
    attached: np.ndarray
    num_inside: np.ndarray
    accompanied: np.ndarray
    num_pairs: int
    gain: float


def measure_objects(
    labels: np.ndarray,
    num_objects: int,
    points: np.ndarray,
    visible: np.ndarray,
    pairs: np.ndarray,
    cameras: Sequence[CameraMotion],
    strict_test: np.ndarray,
    params: RigidSupportParams,
    scene: SceneParallaxParams,
    rigidity: RigidityParams,
) -> ObjectEvidence:
    """Gather the evidence of the tracks in the objects' masks, and around them.

    Depths are compared over the pairs that are farthest apart, in which parallax is largest.

    Parameters
    ----------
    labels : integer (frame, y, x)
        Objects in the first frames of the tracks, 0 = background; 0..num_objects - 1.
    num_objects : int
        The background included.
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    pairs : integer (pair, 2)
        First frame, and frames to the second; those that end beyond `labels` are not read.
    cameras : sequence of CameraMotion
        Of each pair.
    strict_test : floating (pair, track)
        As `estimate_rigidity` returns it; NaN where a track is not seen in both frames.
    params : RigidSupportParams
    scene : SceneParallaxParams
        Of the share that a single plane explains.
    rigidity : RigidityParams
        Of the noise of displacements, and of the fit of the plane.
    """
    num_observations, test = np.zeros((2, num_objects))
    num_contour, num_attached, num_inside, num_accompanied, num_holding = np.zeros((5, num_objects))
    num_pairs, gains = 0, []
    widest = pairs[:, 1].max(initial=0)
    for (start, gap), camera, tests in zip(pairs.tolist(), cameras, strict_test, strict=True):
        if start + gap >= len(labels):
            continue
        num_pairs += 1
        seen = np.flatnonzero(visible[:, start] & visible[:, start + gap] & np.isfinite(tests))
        points0, points1 = (points[seen, frame].astype(np.float64) for frame in (start, start + gap))
        owner, owner1 = labels_at(labels[start], points0), labels_at(labels[start + gap], points1)
        inside = (owner > 0) & (owner == owner1)
        num_observations += np.bincount(owner[inside], minlength=num_objects)
        test += np.bincount(owner[inside], tests[seen[inside]].astype(np.float64), num_objects)
        if gap == widest:
            noise = displacement_noise(points0, points1, rigidity.noise, rigidity.noise_share)
            parallax = split_displacements(points0, points1, camera, labels.shape[1:])
            in_object = np.bincount(owner[inside], minlength=num_objects)
            rows, is_attached = _compare_depths(points0, owner, inside, parallax, noise, params)
            num_contour += np.bincount(owner[rows], minlength=num_objects)
            num_attached += np.bincount(owner[rows], is_attached, num_objects)
            around = (owner == 0) & (owner1 == 0)
            is_explained = np.abs(parallax.across) < noise
            is_accompanied = _have_depth_of(around & is_explained, inside, parallax, noise, params)
            num_accompanied += np.bincount(owner[inside], is_accompanied, num_objects)
            num_inside += in_object
            num_holding += in_object > 0
            if np.count_nonzero(around) >= scene.min_tracks:
                gains.append(_gain(points0, points1, around, is_explained, scene.plane_slack, rigidity))
    return ObjectEvidence(
        num_observations=num_observations.astype(np.int64),
        test=test / np.maximum(num_observations, 1),
        num_contour=num_contour / np.maximum(num_holding, 1),
        attached=np.where(num_contour > 0, num_attached / np.maximum(num_contour, 1), 1.0),
        num_inside=num_inside / np.maximum(num_holding, 1),
        accompanied=np.where(num_inside > 0, num_accompanied / np.maximum(num_inside, 1), 1.0),
        num_pairs=num_pairs,
        gain=float(np.median(gains)) if gains else 0.0,
    )


def _gain(points0, points1, around, is_explained, plane_slack, rigidity) -> float:
    """Return the share of the tracks around all objects that are explained, and that no single plane explains.

    It is 0 if most explained tracks are in objects: the motion that was found is theirs, and not the camera's.
    """
    if 2 * np.count_nonzero(is_explained & around) < np.count_nonzero(is_explained):
        return 0.0
    plane_share = share_of_plane(points0[around], points1[around], plane_slack, rigidity)
    return max(float(is_explained[around].mean()) - plane_share, 0.0)


def _compare_depths(points, owner, inside, parallax, noise, params) -> tuple[np.ndarray, np.ndarray]:
    """Return the tracks inside an object that have some of the background near them, and which may lie at their depth.

    The result is int (C,) and bool (C,).
    """
    inner, outer = np.flatnonzero(inside), np.flatnonzero(owner == 0)
    if not len(inner) or not len(outer):
        return inner[:0], np.zeros(0, bool)
    near = cKDTree(points[outer]).query_ball_point(points[inner], params.contour_distance)
    number = np.repeat(np.arange(len(inner)), [len(each) for each in near])
    other = outer[np.concatenate(near).astype(np.intp)]
    own = inner[number]
    alike = np.bincount(number, _may_be_alike(own, other, parallax, noise, params), len(inner)) > 0
    at_contour = np.bincount(number, minlength=len(inner)) > 0
    return inner[at_contour], alike[at_contour]


def _have_depth_of(others, inside, parallax, noise, params) -> np.ndarray:
    """Return which tracks inside objects may have the inverse depth of `min_contour` or more of some others, bool (M,).

    Those whose inverse depths are nearest are asked, as many above as below. Others whose depth hardly shows, as where
    the camera drives to, may have any; they are not asked.
    """
    inner, outer = np.flatnonzero(inside), np.flatnonzero(others)
    depth_noise = (noise / parallax.reach)[outer]
    outer = outer[depth_noise <= _MOST_NOISE * np.median(depth_noise)] if len(outer) else outer
    needed = max(int(np.ceil(params.min_contour)), 1)
    if len(outer) < needed:
        return np.zeros(len(inner), bool)
    outer = outer[np.argsort(parallax.inverse_depth[outer], kind="stable")]
    above = np.searchsorted(parallax.inverse_depth[outer], parallax.inverse_depth[inner])
    near = above[:, None] + np.arange(-needed, needed)
    is_there = (near >= 0) & (near < len(outer))
    other = outer[near.clip(0, len(outer) - 1)]
    alike = _may_be_alike(np.broadcast_to(inner[:, None], other.shape), other, parallax, noise, params)
    return np.count_nonzero(alike & is_there, axis=1) >= needed


def _may_be_alike(rows, others, parallax, noise, params) -> np.ndarray:
    """Return whether tracks and others, two index arrays of one shape, may lie at one inverse depth."""
    depth, depth_noise = parallax.inverse_depth, noise / parallax.reach
    nearest = np.maximum(np.abs(depth[rows]), np.abs(depth[others]))
    tolerance = np.sqrt((params.depth_slack * nearest) ** 2 + depth_noise[rows] ** 2 + depth_noise[others] ** 2)
    return np.abs(depth[rows] - depth[others]) < tolerance
