"""Evidence of frame pairs: how many tracks a rigid scene explains that no single plane does."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import RigidityParams, SceneParallaxParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.explained_shares import ExplainedShares, explained_shares
from moseg.tasks.rigidity.focal_length import focal_of_pairs
from moseg.tasks.rigidity.relative_pose import fit_pose

_BORDER = 0.15
"""Width of a border, in shorter sides of the frame."""
_MIN_CORNERS = 5  # of a border that can be at rest


class PairEvidence(NamedTuple):
    """Evidence of one frame pair.

    Attributes
    ----------
    motion : float
        Median displacement of the tracks, px.
    explained : ExplainedShares
        Shares of the tracks that a rigid scene, and a single homography, explain.
    heading : float64 (3,)
        Direction in which the scene moves in the camera's axes, against the camera's own: unit length.
    sees_epipole : bool
        Whether the point that the camera moves to, or away from, lies inside the frame.
    """

    motion: float
    explained: ExplainedShares
    heading: np.ndarray
    sees_epipole: bool


def measure_pairs(
    pairs: Sequence[tuple[np.ndarray, np.ndarray]],
    shape: tuple[int, int],
    params: SceneParallaxParams,
    rigidity: RigidityParams,
) -> list[PairEvidence]:
    """Return the evidence of the frame pairs of a stretch over which the camera moves.

    A camera moves if most corners do, unless those at two opposite borders are exactly where they were: someone at work
    before a camera at rest can have most of the corners.

    Parameters
    ----------
    pairs : sequence of (float64 (N, 2), float64 (N, 2))
        Tracks of each pair, xy in its two frames, px.
    shape : (height, width)
    params : SceneParallaxParams
    rigidity : RigidityParams
        Of the camera's motion, its focal length and the noise of displacements.
    """
    moving = [pair for pair in pairs if _has_enough(pair, params) and _camera_moves(*pair, shape, params)]
    # Every other pair determines it as well, in half the time.
    focal = focal_of_pairs(moving[::2], shape, rigidity)
    measured = (_measure(*pair, focal, shape, params, rigidity) for pair in moving)
    return [evidence for evidence in measured if evidence is not None]


def count_still(
    pairs: Sequence[tuple[np.ndarray, np.ndarray]], shape: tuple[int, int], params: SceneParallaxParams
) -> int:
    """Return the number of pairs with enough tracks over which the camera stands still, as `measure_pairs` sees it."""
    return sum(_has_enough(pair, params) and not _camera_moves(*pair, shape, params) for pair in pairs)


def _has_enough(pair: tuple[np.ndarray, np.ndarray], params: SceneParallaxParams) -> bool:
    """Return whether a pair has enough tracks to tell whether the camera moves."""
    return len(pair[0]) >= params.min_tracks


def _measure(points0, points1, focal, shape, params, rigidity) -> PairEvidence | None:
    """Return the evidence of a pair; None where no rigid motion can be fitted."""
    camera = fit_pose(points0, points1, focal, shape, rigidity)
    if camera is None:
        return None
    return PairEvidence(
        motion=_motion(points0, points1),
        explained=explained_shares(points0, points1, camera, shape, params.plane_slack, rigidity),
        heading=camera.translation,
        sees_epipole=_sees_epipole(camera, shape),
    )


def _sees_epipole(camera: CameraMotion, shape: tuple[int, int]) -> bool:
    """Return whether the epipole lies inside the second frame."""
    height, width = shape
    sideways, down, ahead = camera.translation * np.sign(camera.translation[2])
    # Of K t, before the division by its last entry, which may be 0.
    from_centre = camera.focal * np.abs([sideways, down])
    return bool(ahead > 0 and (from_centre <= ahead * np.array([width - 1, height - 1]) / 2).all())


def _camera_moves(
    points0: np.ndarray, points1: np.ndarray, shape: tuple[int, int], params: SceneParallaxParams
) -> bool:
    """Return whether the median displacement is large enough, and no two opposite borders are at rest."""
    displacements = np.linalg.norm(points1 - points0, axis=1)
    if np.median(displacements) < params.min_motion:
        return False
    rests, width = displacements < params.rest_motion, _BORDER * min(shape)
    sides = (
        (points0[:, axis] < width, points0[:, axis] > size - 1 - width) for axis, size in ((0, shape[1]), (1, shape[0]))
    )
    return not any(all(_rests(rests[band], params) for band in pair) for pair in sides)


def _rests(rests: np.ndarray, params: SceneParallaxParams) -> bool:
    """Return whether enough of a border's corners are at rest, and there are enough of these."""
    return len(rests) >= _MIN_CORNERS and rests.mean() >= params.rest_share


def _motion(points0: np.ndarray, points1: np.ndarray) -> float:
    """Return the median displacement, px."""
    return float(np.median(np.linalg.norm(points1 - points0, axis=1)))
