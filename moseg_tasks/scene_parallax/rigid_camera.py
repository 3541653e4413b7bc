"""A calibrated camera's motion between two frames, its epipolar errors, and the choice of its focal length."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import poselib

from moseg.schemas.parameters import SceneParallaxParams

FOCALS = (0.45, 0.53, 0.62, 0.73, 0.86, 1.0, 1.2, 1.4)
"""Focal lengths tried, in longer sides of the frame: fields of view of 96 to 39 degrees."""
USUAL_FOCAL = 0.7
FOCAL_SLACK = 0.002
"""Of the focal lengths whose mean error exceeds the smallest by at most this, the one nearest the usual is chosen."""
_MIN_INLIERS = 12


class RigidCamera(NamedTuple):
    """Motion of a camera with square pixels and its principal point in the frame's middle.

    Attributes
    ----------
    rotation : float64 (3, 3)
    translation : float64 (3,)
        Unit length.
    calibration : float64 (3, 3)
        px.
    """

    rotation: np.ndarray
    translation: np.ndarray
    calibration: np.ndarray

    def sees_epipole(self, shape: tuple[int, int]) -> bool:
        """Return whether the epipole lies inside the second frame, which the camera moves to or away from."""
        x, y, depth = self.calibration @ self.translation * np.sign(self.translation[2])
        height, width = shape
        return bool(0 <= x <= (width - 1) * depth and 0 <= y <= (height - 1) * depth and depth > 0)


def fit_camera(
    points0: np.ndarray, points1: np.ndarray, focal: float, shape: tuple[int, int], params: SceneParallaxParams
) -> RigidCamera | None:
    """Fit the camera's motion with which most of the tracks agree; None where there are too few.

    Parameters
    ----------
    points0, points1 : float64 (N, 2)
        xy in the two frames, px.
    focal : float
        Focal length in longer sides of the frame.
    shape : (int, int)
        Height and width of the frames, px.
    params : SceneParallaxParams

    References
    ----------
    D. Nister, An efficient solution to the five-point relative pose problem, TPAMI 2004.
    V. Larsson, PoseLib - minimal solvers for camera pose estimation, https://github.com/PoseLib/PoseLib.
    """
    if len(points0) < _MIN_INLIERS:
        return None
    height, width = shape
    length, centre_x, centre_y = focal * max(shape), (width - 1) / 2, (height - 1) / 2
    intrinsics = [length, centre_x, centre_y]
    camera = {"model": "SIMPLE_PINHOLE", "width": width, "height": height, "params": intrinsics}
    options = {
        "max_epipolar_error": params.threshold,
        "min_iterations": params.num_samples,
        "max_iterations": 2 * params.num_samples,
        "seed": 0,
    }
    pose, report = poselib.estimate_relative_pose(points0, points1, camera, camera, options, {})
    size = np.linalg.norm(pose.t)
    if report["num_inliers"] < _MIN_INLIERS or not np.isfinite(pose.R).all() or not 0 < size < np.inf:
        return None
    calibration = np.array([[length, 0, centre_x], [0, length, centre_y], [0, 0, 1]])
    return RigidCamera(np.asarray(pose.R), pose.t / size, calibration)


def error_across(points0: np.ndarray, points1: np.ndarray, camera: RigidCamera) -> np.ndarray:
    """Return the distance of each point in the second frame to its epipolar line: float64 (N,), px."""
    infinite = camera.calibration @ camera.rotation @ np.linalg.inv(camera.calibration)
    rotated = np.concatenate([points0, np.ones((len(points0), 1))], axis=1) @ infinite.T
    lines = np.cross(np.broadcast_to(camera.calibration @ camera.translation, rotated.shape), rotated)
    offset = (lines[:, :2] * points1).sum(axis=1) + lines[:, 2]
    return np.abs(offset) / np.maximum(np.linalg.norm(lines[:, :2], axis=1), 1e-12)


def tolerance(points0: np.ndarray, points1: np.ndarray, params: SceneParallaxParams) -> np.ndarray:
    """Return the error that each track may have by its displacement: float64 (N,), px."""
    return np.hypot(params.noise, params.relative_noise * np.linalg.norm(points1 - points0, axis=1))


def choose_focal(
    pairs: Sequence[tuple[np.ndarray, np.ndarray]], shape: tuple[int, int], params: SceneParallaxParams
) -> float:
    """Return the focal length, in longer sides, under which rigid motion explains the tracks of all pairs best.

    Parameters
    ----------
    pairs : sequence of (float64 (N, 2), float64 (N, 2))
        Tracks of each frame pair.
    """
    errors = np.array([[_mean_error(*pair, focal, shape, params) for focal in FOCALS] for pair in pairs]).mean(axis=0)
    near_best = np.flatnonzero(errors <= errors.min() + FOCAL_SLACK)
    distance = np.abs(np.log(np.array(FOCALS)[near_best] / USUAL_FOCAL))
    return FOCALS[near_best[np.argmin(distance)]]


def _mean_error(points0, points1, focal, shape, params) -> float:
    """Return the mean squared error in tolerances, at most 1 for each track."""
    camera = fit_camera(points0, points1, focal, shape, params)
    if camera is None:
        return 1.0
    squared = (error_across(points0, points1, camera) / tolerance(points0, points1, params)) ** 2
    return float(np.minimum(squared, 1).mean())
