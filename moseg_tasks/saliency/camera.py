"""Rigid camera motion fitted to flow, and flow along and across its epipolar lines."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.geometry.camera_motion import CameraMotion, estimate_camera_motion
from moseg.tasks.geometry.epipolar_split import split_along_epipolar
from moseg.tasks.saliency.background import sample_flow

_MINIMAL_SAMPLE = 5


class EpipolarFlow(NamedTuple):
    """Flow of each pixel relative to the camera's rotation, along and across its epipolar line; float32 (y, x) each.

    Attributes
    ----------
    across : px/frame; 0 for static points of any depth.
    along : px/frame; the parallax, which grows with inverse depth.
    reach : px/frame; parallax of a pixel at unit inverse depth, so that inverse depth is ``along / reach``.
    towards_x, towards_y : unit vector of growing inverse depth.
    """

    across: np.ndarray
    along: np.ndarray
    reach: np.ndarray
    towards_x: np.ndarray
    towards_y: np.ndarray


def fit_camera_motion(flow: np.ndarray, focal: float, params: SaliencyParams) -> CameraMotion | None:
    """Fit the rigid camera motion with which most of the flow agrees, in front of the camera.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame.
    focal : float
        Focal length in longer sides of the frame.
    params : SaliencyParams

    Returns
    -------
    CameraMotion or None
        None if the flow has too few samples or no motion has enough inliers.
    """
    points, vectors = sample_flow(flow, params.camera_step)
    if len(points) <= _MINIMAL_SAMPLE:
        return None
    return estimate_camera_motion(
        points,
        points + vectors,
        flow.shape[:2],
        focal,
        threshold=params.camera_threshold,
        num_iterations=(params.camera_iterations, 10 * params.camera_iterations),
        min_inliers=_MINIMAL_SAMPLE + 1,
        seed=params.ransac_seed,
    )


def split_flow(flow: np.ndarray, motion: CameraMotion, step: int = 1) -> EpipolarFlow:
    """Split the flow float32 (y, x, 2) at every `step`-th pixel into parts along and across the epipolar lines."""
    height, width = flow.shape[:2]
    centre_x, centre_y = (width - 1) / 2, (height - 1) / 2
    calibration = np.array([[motion.focal, 0, centre_x], [0, motion.focal, centre_y], [0, 0, 1]])
    infinite = (calibration @ motion.rotation @ np.linalg.inv(calibration)).astype(np.float32)
    epipole = (calibration @ motion.translation).astype(np.float32)
    x, y = (np.arange(0, size, step, dtype=np.float32) for size in (width, height))
    y = y[:, None]
    moved_x, moved_y = x + flow[::step, ::step, 0], y + flow[::step, ::step, 1]
    parts = split_along_epipolar(x, y, moved_x, moved_y, infinite, epipole)
    return EpipolarFlow(parts.across, parts.along, parts.reach, parts.towards_x, parts.towards_y)
