"""Motion of a calibrated camera between two frames, from tracks spread over the frame."""

import numpy as np
import poselib

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.saliency.camera import CameraMotion

_MINIMAL_TRACKS = 16


def fit_pose(
    points0: np.ndarray, points1: np.ndarray, focal: float, shape: tuple[int, int], params: RigidityParams
) -> CameraMotion | None:
    """Fit the rigid motion with which most tracks agree, one track per cell so that texture has no say.

    An essential matrix has no freedom to fit a slow car on the same road, as a fundamental matrix would.

    Parameters
    ----------
    points0, points1 : float64 (N, 2)
        xy of the tracks in both frames, px.
    focal : float
        Focal length in longer sides of the frame.
    shape : (height, width)
    params : RigidityParams

    Returns
    -------
    CameraMotion or None
        None if there are too few tracks or inliers.

    References
    ----------
    D. Nister, An efficient solution to the five-point relative pose problem, TPAMI 2004.
    V. Larsson, PoseLib - minimal solvers for camera pose estimation, https://github.com/PoseLib/PoseLib.
    """
    chosen = one_per_cell(points0, params.pose_cell)
    if len(chosen) < _MINIMAL_TRACKS:
        return None
    height, width = shape
    length = focal * max(height, width)
    camera = {
        "model": "SIMPLE_PINHOLE",
        "width": width,
        "height": height,
        "params": [length, (width - 1) / 2, (height - 1) / 2],
    }
    options = {
        "max_epipolar_error": params.pose_threshold,
        "min_iterations": params.pose_iterations // 2,
        "max_iterations": params.pose_iterations,
        "seed": params.seed,
    }
    pose, report = poselib.estimate_relative_pose(points0[chosen], points1[chosen], camera, camera, options, {})
    size = np.linalg.norm(pose.t)
    if report["num_inliers"] < params.pose_inliers or not np.isfinite(pose.R).all() or not 0 < size < np.inf:
        return None
    return CameraMotion(np.asarray(pose.R), pose.t / size, length)


def one_per_cell(points: np.ndarray, cell: int) -> np.ndarray:
    """Return the index of the first of the points (N, 2) in each square cell of side `cell`, px."""
    column, row = (points.T / cell).astype(np.int64)
    return np.unique(row * (1 << 32) + column, return_index=True)[1]
