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
    length = focal * max(shape)
    camera = _camera(length, shape)
    options = {
        "max_epipolar_error": threshold,
        "min_iterations": num_iterations[0],
        "max_iterations": num_iterations[1],
        "seed": seed,
    }
    pose, report = poselib.estimate_relative_pose(points0, points1, camera, camera, options, {})
    return None if report["num_inliers"] < min_inliers else _motion(pose, length)


def refine_camera_motion(
    points0: np.ndarray, points1: np.ndarray, shape: tuple[int, int], motion: CameraMotion, *, loss_scale: float
) -> CameraMotion | None:
    """Return the nearest motion whose epipolar errors are locally the smallest, by PoseLib.

    Parameters
    ----------
    points0, points1 : floating (N, 2)
        xy of the points in both frames, px.
    shape : (height, width)
        Of the frames, px.
    motion : CameraMotion
        Where to begin.
    loss_scale : float
        Epipolar error from which a point counts ever less (Cauchy), px.

    Returns
    -------
    CameraMotion or None
        None if the result is not finite.
    """
    start = poselib.CameraPose()
    start.R, start.t = motion.rotation, motion.translation
    camera = _camera(motion.focal, shape)
    options = {"loss_type": "CAUCHY", "loss_scale": loss_scale}
    pose, _ = poselib.refine_relative_pose(points0, points1, start, camera, camera, options)
    return _motion(pose, motion.focal)


def refine_camera_pose(
    points0: np.ndarray,
    points1: np.ndarray,
    shape: tuple[int, int],
    pose: np.ndarray,
    length: float,
    *,
    loss_scale: float,
) -> np.ndarray:
    """Return the nearest motion that brings points in space to pixels with locally the smallest errors, by PoseLib.

    Parameters
    ----------
    points0 : float64 (N, 3)
        In the first camera's axes.
    points1 : float64 (N, 2)
        xy in the second frame, px.
    shape : (height, width)
        Of the frames, px.
    pose : float64 (3, 4)
        [R | t] from the first to the second camera's axes, where to begin.
    length : float
        Focal length, px.
    loss_scale : float
        Error from which a point counts for nothing (truncated squares), px.

    Returns
    -------
    float64 (3, 4)
        [R | t].
    """
    start = poselib.CameraPose()
    start.R, start.t = pose[:, :3], pose[:, 3]
    options = {"loss_type": "TRUNCATED", "loss_scale": loss_scale}
    found, _ = poselib.refine_absolute_pose(points1, points0, start, _camera(length, shape), options)
    return np.column_stack([found.R, found.t])


def _camera(length: float, shape: tuple[int, int]) -> dict:
    """Return PoseLib's description of a camera of focal length `length`, px."""
    height, width = shape
    params = [length, (width - 1) / 2, (height - 1) / 2]
    return {"model": "SIMPLE_PINHOLE", "width": width, "height": height, "params": params}


def _motion(pose: poselib.CameraPose, length: float) -> CameraMotion | None:
    size = np.linalg.norm(pose.t)
    if not np.isfinite(pose.R).all() or not 0 < size < np.inf:
        return None
    return CameraMotion(np.asarray(pose.R), pose.t / size, length)
