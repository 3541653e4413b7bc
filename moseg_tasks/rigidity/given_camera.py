"""A given motion of the camera over a frame pair, and given depth in its unit, corrected by the tracks of the pair."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion, refine_camera_motion, refine_camera_pose
from moseg.tasks.rigidity.given_depth import sample_depth
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.rigidity.relative_pose import MINIMAL_TRACKS, one_per_cell

_FARTHEST = 1e-6
"""Least inverse depth, as a share of the largest, for which a point in space is computed."""


class GivenCamera(NamedTuple):
    """Camera's motion in a pair.

    Attributes
    ----------
    motion : CameraMotion
    length : float
        Of its translation, in the unit of the depth given with it.
    cost : float
        Mean squared deviation of tracks from it, in squares of their noise and at most 1.
    """

    motion: CameraMotion
    length: float
    cost: float


class _Pair(NamedTuple):
    """Tracks of a pair whose depth is given, one per cell: xy in both frames, px, and inverse depth."""

    points0: np.ndarray
    points1: np.ndarray
    inverse_depth: np.ndarray
    shape: tuple[int, int]


def correct_camera(
    pose: np.ndarray,
    inverse_depth: np.ndarray,
    points0: np.ndarray,
    points1: np.ndarray,
    focal: float,
    params: RigidityParams,
) -> GivenCamera | None:
    """Correct a given motion of the camera by tracks, one per cell as in a fit to tracks alone.

    Tracks show a rotation more exactly than a network estimates it: unless it is corrected, a motion of the camera
    would mark the whole frame. First the positions of tracks at their given depths are brought to those in the second
    frame, which also fits the length of the translation to the depth. Only tracks within `params.camera_slip` of where
    the motion brings them count, then within half of it, down to `params.pose_threshold`; so a mover does not draw the
    motion to itself, though it may own most tracks. Then the epipolar error alone is minimised, because depth is less
    exact than positions. Each result counts where tracks deviate less from it.

    Parameters
    ----------
    pose : float64 (3, 4)
        [R | t] from the first to the second frame's camera.
    inverse_depth : float32 (y, x)
        Of the first frame, in the inverse of the unit of t.
    points0, points1 : float64 (N, 2)
        xy of the tracks in both frames, px.
    focal : float
        Focal length in longer sides of the frame.
    params : RigidityParams

    Returns
    -------
    GivenCamera or None
        None if there are too few tracks, or the motion explains too few of them.
    """
    chosen = one_per_cell(points0, params.pose_cell)
    at_tracks = sample_depth(inverse_depth, points0[chosen])
    chosen, at_tracks = chosen[at_tracks > 0], at_tracks[at_tracks > 0]
    if len(chosen) < MINIMAL_TRACKS:
        return None
    pair = _Pair(points0[chosen], points1[chosen], at_tracks, inverse_depth.shape)
    best, deviation = _measure(pose, focal, pair, params)
    if params.camera_slip > 0:
        for refined in _refinements(pose, focal, pair, params):
            found, found_deviation = _measure(refined, focal, pair, params)
            if found.cost < best.cost:
                best, deviation = found, found_deviation
    return best if np.mean(deviation < 1) >= params.camera_share else None


def _refinements(pose: np.ndarray, focal: float, pair: _Pair, params: RigidityParams) -> Iterator[np.ndarray]:
    """Yield motions [R | t] (3, 4) that deviate less from the tracks, from the coarsest to the finest."""
    length = focal * max(pair.shape)
    centre = (np.array(pair.shape[::-1]) - 1) / 2
    far = np.maximum(pair.inverse_depth, _FARTHEST * pair.inverse_depth.max())
    rays = np.column_stack([(pair.points0 - centre) / length, np.ones(len(far))])
    reach = max(params.camera_slip, params.pose_threshold)
    while reach >= params.pose_threshold:
        pose = refine_camera_pose(rays / far[:, None], pair.points1, pair.shape, pose, length, loss_scale=reach)
        if not np.isfinite(pose).all():
            return
        yield pose
        reach /= 2
    motion, size = _split(pose, length)
    refined = refine_camera_motion(pair.points0, pair.points1, pair.shape, motion, loss_scale=params.pose_threshold)
    if refined is not None:
        yield np.column_stack([refined.rotation, size * refined.translation])


def _measure(pose: np.ndarray, focal: float, pair: _Pair, params: RigidityParams) -> tuple[GivenCamera, np.ndarray]:
    """Return the motion with its cost, and the deviation of each track in standard deviations."""
    motion, size = _split(pose, focal * max(pair.shape))
    parallax = split_displacements(pair.points0, pair.points1, motion, pair.shape)
    noise = displacement_noise(pair.points0, pair.points1, params.noise, params.noise_share)
    expected = parallax.at(size * pair.inverse_depth)
    along = (parallax.along - expected) / np.hypot(noise, params.depth_noise * expected)
    deviation = np.hypot(along, parallax.across / noise)
    return GivenCamera(motion, size, float(np.mean(np.minimum(deviation**2, 1)))), deviation


def _split(pose: np.ndarray, length: float) -> tuple[CameraMotion, float]:
    """Return the motion of a pose, and the length of its translation; one of length 0 is ahead, like any other."""
    size = float(np.linalg.norm(pose[:, 3]))
    return CameraMotion(pose[:, :3], pose[:, 3] / size if size > 0 else np.array([0.0, 0.0, 1.0]), length), size
