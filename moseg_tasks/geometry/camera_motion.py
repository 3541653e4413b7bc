"""Rigid motion of a calibrated camera between two frames, from matching points."""

from typing import NamedTuple

import numpy as np
import poselib


class CameraMotion(NamedTuple):
    """Rigid motion of the scene seen by a camera with square pixels and its principal point in the frame's middle.

    Attributes
    ----------
    rotation : float64 (3, 3)
    translation : float64 (3,)
        Unit length, because two views do not determine the scale.
    focal : float
        Focal length, px.
    """

    rotation: np.ndarray
    translation: np.ndarray
    focal: float


def estimate_camera_motion(
    points0: np.ndarray,
    points1: np.ndarray,
    shape: tuple[int, int],
    focal: float,
    *,
    threshold: float,
    num_iterations: tuple[int, int],
    min_inliers: int,
    seed: int,
) -> CameraMotion | None:
    """Return PoseLib's robust estimate of the rigid motion with which most points agree, in front of the camera.

    Parameters
    ----------
    points0, points1 : floating (N, 2)
        xy of the points in both frames, px; N >= 5.
    shape : (height, width)
        Of the frames, px.
    focal : float
        Focal length in longer sides of the frame.
    threshold : float
        Epipolar error of an inlier, px.
    num_iterations : (int, int)
        Minimal samples drawn at least and at most.
    min_inliers : int
        Number of inliers below which there is no motion.
    seed : int

    References
    ----------
    D. Nister, An efficient solution to the five-point relative pose problem, TPAMI 2004.
    V. Larsson, PoseLib - minimal solvers for camera pose estimation, https://github.com/PoseLib/PoseLib.
    """
    height, width = shape
    length = focal * max(height, width)
    camera = {
        "model": "SIMPLE_PINHOLE",
        "width": width,
        "height": height,
        "params": [length, (width - 1) / 2, (height - 1) / 2],
    }
    options = {
        "max_epipolar_error": threshold,
        "min_iterations": num_iterations[0],
        "max_iterations": num_iterations[1],
        "seed": seed,
    }
    pose, report = poselib.estimate_relative_pose(points0, points1, camera, camera, options, {})
    size = np.linalg.norm(pose.t)
    if report["num_inliers"] < min_inliers or not np.isfinite(pose.R).all() or not 0 < size < np.inf:
        return None
    return CameraMotion(np.asarray(pose.R), pose.t / size, length)
