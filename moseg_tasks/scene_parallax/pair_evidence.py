"""Evidence of frame pairs: how many tracks a rigid scene explains that no single plane does."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import poselib

from moseg.schemas.parameters import RigidityParams, SceneParallaxParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.focal_length import focal_of_pairs
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.rigidity.relative_pose import fit_pose, one_per_cell


class PairEvidence(NamedTuple):
    """Evidence of one frame pair.

    Attributes
    ----------
    motion : float
        Median displacement of the tracks, px.
    rigid_share, plane_share : float
        Shares of the tracks that a rigid scene, and a single homography, explain.
    heading : float64 (3,)
        Direction in which the scene moves in the camera's axes, against the camera's own: unit length.
    sees_epipole : bool
        Whether the point that the camera moves to, or away from, lies inside the frame.
    """

    motion: float
    rigid_share: float
    plane_share: float
    heading: np.ndarray
    sees_epipole: bool


def measure_pairs(
    pairs: Sequence[tuple[np.ndarray, np.ndarray]],
    shape: tuple[int, int],
    params: SceneParallaxParams,
    rigidity: RigidityParams,
) -> list[PairEvidence]:
    """Return the evidence of the frame pairs of a stretch over which the camera moves.

    Parameters
    ----------
    pairs : sequence of (float64 (N, 2), float64 (N, 2))
        Tracks of each pair, xy in its two frames, px.
    shape : (height, width)
    params : SceneParallaxParams
    rigidity : RigidityParams
        Of the camera's motion, its focal length and the noise of displacements.
    """
    moving = [pair for pair in pairs if len(pair[0]) >= params.min_tracks and _motion(*pair) >= params.min_motion]
    # Every other pair determines it as well, in half the time.
    focal = focal_of_pairs(moving[::2], shape, rigidity)
    measured = (_measure(*pair, focal, shape, params, rigidity) for pair in moving)
    return [evidence for evidence in measured if evidence is not None]


def _measure(points0, points1, focal, shape, params, rigidity) -> PairEvidence | None:
    """Return the evidence of a pair; None where no rigid motion can be fitted."""
    camera = fit_pose(points0, points1, focal, shape, rigidity)
    if camera is None:
        return None
    noise = displacement_noise(points0, points1, rigidity.noise, rigidity.noise_share)
    across = split_displacements(points0, points1, camera, shape).across
    plane_error = _homography_error(points0, points1, rigidity)
    return PairEvidence(
        motion=_motion(points0, points1),
        rigid_share=float((np.abs(across) < noise).mean()),
        plane_share=float((plane_error < params.plane_slack * noise).mean()),
        heading=camera.translation,
        sees_epipole=_sees_epipole(camera, shape),
    )


def _homography_error(points0: np.ndarray, points1: np.ndarray, rigidity: RigidityParams) -> np.ndarray:
    """Return the transfer error under the homography of most tracks, one per cell: float64 (N,), px."""
    options = {
        "max_reproj_error": rigidity.pose_threshold,
        "min_iterations": rigidity.pose_iterations // 2,
        "max_iterations": rigidity.pose_iterations,
        "seed": rigidity.seed,
    }
    chosen = one_per_cell(points0, rigidity.pose_cell)
    H, _ = poselib.estimate_homography(points0[chosen], points1[chosen], options, {})
    moved = np.column_stack([points0, np.ones(len(points0))]) @ np.asarray(H).T
    # A homography may send a point to infinity: it does not explain it.
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(np.linalg.norm(moved[:, :2] / moved[:, 2:] - points1, axis=1), nan=np.inf)


def _sees_epipole(camera: CameraMotion, shape: tuple[int, int]) -> bool:
    """Return whether the epipole lies inside the second frame."""
    height, width = shape
    sideways, down, ahead = camera.translation * np.sign(camera.translation[2])
    # Of K t, before the division by its last entry, which may be 0.
    from_centre = camera.focal * np.abs([sideways, down])
    return bool(ahead > 0 and (from_centre <= ahead * np.array([width - 1, height - 1]) / 2).all())


def _motion(points0: np.ndarray, points1: np.ndarray) -> float:
    """Return the median displacement, px."""
    return float(np.median(np.linalg.norm(points1 - points0, axis=1)))
