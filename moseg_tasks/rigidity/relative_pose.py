"""Motion of a calibrated camera between two frames, from tracks spread over the frame."""

import numpy as np

from moseg.schemas.parameters import RigidityParams
from moseg.tasks.geometry.camera_motion import CameraMotion, estimate_camera_motion

MINIMAL_TRACKS = 16


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
    """
    chosen = one_per_cell(points0, params.pose_cell)
    if len(chosen) < MINIMAL_TRACKS:
        return None
    return estimate_camera_motion(
        points0[chosen],
        points1[chosen],
        shape,
        focal,
        threshold=params.pose_threshold,
        num_iterations=(params.pose_iterations // 2, params.pose_iterations),
        min_inliers=params.pose_inliers,
        seed=params.seed,
    )


def one_per_cell(points: np.ndarray, cell: int) -> np.ndarray:
    """Return the index of the first of the points (N, 2) in each square cell of side `cell`, px."""
    column, row = (points.T / cell).astype(np.int64)
    return np.unique(row * (1 << 32) + column, return_index=True)[1]
