"""Motions of the camera in frame pairs, each also sought from those of pairs near in time."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion, refine_camera_motion
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.rigidity.relative_pose import fit_pose, one_per_cell

_ALIKE = np.cos(np.radians(2))
"""Cosine of the angle between directions of travel from which the same motion is found."""
_LOSS = 0.25
"""Epipolar error from which a track counts ever less in a refinement, in errors of an inlier."""


class PairTracks(NamedTuple):
    """Tracks that are seen in both frames of a pair.

    Attributes
    ----------
    start : int
        First frame.
    points0, points1 : float64 (N, 2)
        xy in both frames, px.
    """

    start: int
    points0: np.ndarray
    points1: np.ndarray


def fit_motions(
    pairs: Sequence[PairTracks], focal: float, shape: tuple[int, int], params: RigidityParams
) -> list[CameraMotion | None]:
    """Fit the camera's motion in each of several frame pairs of a window.

    Where most of the scene is far and a vehicle is near, random samples may find a motion that explains the vehicle and
    not the near ground; it seldom happens in two pairs alike. Therefore the motion of a pair (`fit_pose`) competes with
    those that are refined from it in the directions in which the camera travels in pairs that start up to
    `params.pose_reach` frames away. That with the least cost is taken, the mean over one track per cell of the squared
    distance from the epipolar line, in squares of its noise and at most 1, which is also the cost of a track behind
    infinity.

    Parameters
    ----------
    pairs : sequence of PairTracks
    focal : float
        Focal length in longer sides of the frame.
    shape : (height, width)
    params : RigidityParams

    Returns
    -------
    list of CameraMotion or None
        None where a pair has too few tracks or inliers (`fit_pose`).
    """
    fitted = [fit_pose(pair.points0, pair.points1, focal, shape, params) for pair in pairs]
    starts = np.array([pair.start for pair in pairs])
    motions = []
    for pair, own in zip(pairs, fitted, strict=True):
        if own is None:
            motions.append(None)
            continue
        near = np.flatnonzero(np.abs(starts - pair.start) <= params.pose_reach)
        others = (fitted[index] for index in near if fitted[index] is not None)
        motions.append(_best_motion(pair, own, _other_directions(own, others), shape, params))
    return motions


def _other_directions(own: CameraMotion, others: Iterable[CameraMotion]) -> list[np.ndarray]:
    """Return the directions in which others travel, float64 (3,), without those that are like one before."""
    different = [own.translation]
    for motion in others:
        if np.max(different @ motion.translation) < _ALIKE:
            different.append(motion.translation)
    return different[1:]


def _best_motion(
    pair: PairTracks,
    own: CameraMotion,
    directions: Sequence[np.ndarray],
    shape: tuple[int, int],
    params: RigidityParams,
) -> CameraMotion:
    """Return the motion of least cost among a pair's own and those refined from it in each of the directions."""
    if not directions:
        return own
    chosen = one_per_cell(pair.points0, params.pose_cell)
    points = pair.points0[chosen], pair.points1[chosen]
    noise = displacement_noise(*points, params.noise, params.noise_share)

    def cost(motion):
        parallax = split_displacements(*points, motion, shape)
        squared = np.minimum((parallax.across / noise) ** 2, 1)
        return np.mean(np.where(parallax.along < -noise, 1, squared))

    scale = _LOSS * params.pose_threshold
    starts = (own._replace(translation=direction) for direction in directions)
    refined = [refine_camera_motion(*points, shape, start, loss_scale=scale) for start in starts]
    return min([own, *(motion for motion in refined if motion is not None)], key=cost)
