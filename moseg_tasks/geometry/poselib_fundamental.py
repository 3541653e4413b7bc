"""Fundamental matrices by PoseLib: seven-point LO-RANSAC and non-linear refinement of the Sampson error."""

import numpy as np
import poselib

from moseg.tasks.geometry.ransac import RobustFit
from moseg.tasks.geometry.sampson import sampson_squared


def poselib_fundamental(
    points0: np.ndarray, points1: np.ndarray, *, threshold: float, num_samples: int, rng: np.random.Generator
) -> RobustFit | None:
    """Return PoseLib's robust estimate, or None if it finds no model.

    Parameters
    ----------
    points0, points1 : float64 (N, 2)
        Matching points, N >= 8.
    threshold : float
        Sampson distance of an inlier, in the unit of the points.
    num_samples : int
        Minimal samples drawn; there is no early stop.
    rng : numpy.random.Generator
        Seeds PoseLib's own generator: equal seeds give equal bytes.

    References
    ----------
    V. Larsson, PoseLib - minimal solvers for camera pose estimation, https://github.com/PoseLib/PoseLib.
    """
    options = {
        "max_epipolar_error": threshold,
        "seed": int(rng.integers(2**31)),
        "max_iterations": num_samples,
        "min_iterations": num_samples,
    }
    matrix, info = poselib.estimate_fundamental(points0, points1, options, {"loss_scale": threshold})
    # Without a model PoseLib returns uninitialised memory.
    if info["num_inliers"] == 0 or not np.isfinite(matrix).all() or not matrix.any():
        return None
    matrix = matrix / np.linalg.norm(matrix)
    return RobustFit(matrix, sampson_squared(matrix, points0, points1) < threshold**2)
