"""Motions of the camera in frame pairs, each also sought from those of pairs near in time."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion, refine_camera_motion
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.rigidity.relative_pose import fit_pose, one_per_cell

_ALIKE = np.cos(np.radians(2))
"""Cosine of the angle between directions of travel from which the same motion is found."""
_MAX_DIRECTIONS = 4
"""Directions that are tried for a pair at most: of a camera at rest, each pair shows another."""
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
    pairs: Sequence[PairTracks],
    focal: float,
    shape: tuple[int, int],
    params: RigidityParams,
    step: int = 1,
    known: Mapping[int, CameraMotion] = MappingProxyType({}),
) -> list[CameraMotion | None]:
    """Fit the camera's motion in each of several frame pairs of a window.

    Where most of the scene is far and a vehicle is near, random samples may find a motion that explains the vehicle and
    not the near ground; it seldom happens in two pairs alike. Therefore the motion of a pair (`fit_pose`) competes with
    those that are refined from it in the directions in which the camera travels in pairs that start up to
    `params.pose_reach` frames away, or next to it: in up to four that differ, in which it does most often. That with
    the least cost is taken, the mean over one track per cell of the squared distance from the epipolar line, in squares
    of its noise and at most 1, which is also the cost of a track behind infinity.

    Parameters
    ----------
    pairs : sequence of PairTracks
    focal : float
        Focal length in longer sides of the frame.
    shape : (height, width)
    params : RigidityParams
        With a `pose_reach` of 0, each pair has its own motion.
    step : int, optional
        Frames between the first frames of pairs.
    known : mapping of int to CameraMotion, optional
        Motions that are not fitted, by the index of their pair.

    Returns
    -------
    list of CameraMotion or None
        None where a pair has too few tracks or inliers (`fit_pose`).
    """
    fitted = [
        known[index] if index in known else fit_pose(pair.points0, pair.points1, focal, shape, params)
        for index, pair in enumerate(pairs)
    ]
    if params.pose_reach == 0:
        return fitted
    starts, reach = np.array([pair.start for pair in pairs]), max(params.pose_reach, step)
    motions = []
    for index, (pair, own) in enumerate(zip(pairs, fitted, strict=True)):
        if own is not None and index not in known:
            near = np.flatnonzero(np.abs(starts - pair.start) <= reach)
            others = [fitted[other].translation for other in near if fitted[other] is not None]
            own = _best_motion(pair, own, _main_directions(own.translation, others), shape, params)
        motions.append(own)
    return motions


def _main_directions(own: np.ndarray, others: Sequence[np.ndarray]) -> list[np.ndarray]:
    """Return the directions (3,) that most others are like, the first of those that are alike, without the own one."""
    different, support = [own], [0]
    for direction in others:
        likeness = different @ direction
        if likeness.max() >= _ALIKE:
            support[likeness.argmax()] += 1
        else:
            different.append(direction)
            support.append(1)
    order = np.argsort(-np.array(support[1:]), kind="stable")[:_MAX_DIRECTIONS]
    return [different[index + 1] for index in order]


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
