"""Shares of tracks that a rigid scene of any depth, and a single plane, explain: their difference shows depth."""

from typing import NamedTuple

import numpy as np
import poselib

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.rigidity.noise import displacement_noise
from moseg.tasks.rigidity.parallax import split_displacements
from moseg.tasks.rigidity.relative_pose import one_per_cell

_MINIMAL_CELLS = 4
"""Tracks that determine a homography."""


class ExplainedShares(NamedTuple):
    """Shares of the tracks of a frame pair, 0..1.

    Attributes
    ----------
    rigid : float
        Explained by the camera's motion past a rigid scene.
    plane : float
        Explained by a single homography.
    """

    rigid: float
    plane: float

    @property
    def gain(self) -> float:
        """Share that only the rigid scene explains; 0 if the plane explains as much."""
        return max(self.rigid - self.plane, 0.0)


def explained_shares(
    points0: np.ndarray,
    points1: np.ndarray,
    camera: CameraMotion,
    shape: tuple[int, int],
    plane_slack: float,
    params: RigidityParams,
) -> ExplainedShares:
    """Return the shares of the tracks that a rigid scene and the homography of most of them explain.

    Parameters
    ----------
    points0, points1 : float64 (N, 2)
        xy of the tracks in both frames, px; N > 0.
    camera : CameraMotion
        From the first frame to the second.
    shape : (height, width)
    plane_slack : float
        Error allowed under the homography, in those allowed under the rigid scene.
    params : RigidityParams
        Of the noise of displacements and of the fit.
    """
    noise = displacement_noise(points0, points1, params.noise, params.noise_share)
    across = split_displacements(points0, points1, camera, shape).across
    rigid = float((np.abs(across) < noise).mean())
    return ExplainedShares(rigid, share_of_plane(points0, points1, plane_slack, params))


def share_of_plane(points0: np.ndarray, points1: np.ndarray, slack: float, params: RigidityParams) -> float:
    """Return the share of the tracks (N, 2) that the homography of most of them explains.

    It is 1 where the tracks lie in too few cells for one homography: many fit then. `slack` is the error allowed, in
    those allowed under a rigid scene; see `explained_shares` for the rest.
    """
    chosen = one_per_cell(points0, params.pose_cell)
    if len(chosen) < _MINIMAL_CELLS:
        return 1.0
    noise = displacement_noise(points0, points1, params.noise, params.noise_share)
    return float((_homography_error(points0, points1, chosen, params) < slack * noise).mean())


def _homography_error(
    points0: np.ndarray, points1: np.ndarray, chosen: np.ndarray, params: RigidityParams
) -> np.ndarray:
    """Return the transfer error under the homography of most of the chosen tracks: float64 (N,), px."""
    options = {
        "max_reproj_error": params.pose_threshold,
        "min_iterations": params.pose_iterations // 2,
        "max_iterations": params.pose_iterations,
        "seed": params.seed,
    }
    H, _ = poselib.estimate_homography(points0[chosen], points1[chosen], options, {})
    moved = np.column_stack([points0, np.ones(len(points0))]) @ np.asarray(H).T
    # A homography may send a point to infinity: it does not explain it.
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.nan_to_num(np.linalg.norm(moved[:, :2] / moved[:, 2:] - points1, axis=1), nan=np.inf)
