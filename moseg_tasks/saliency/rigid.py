"""Rigid background: a static scene of any depth on a ground plane, seen by a moving camera."""

import cv2
import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.geometry.camera_motion import CameraMotion
from moseg.tasks.saliency.camera import EpipolarFlow, split_flow
from moseg.tasks.saliency.ground import fit_ground
from moseg.tasks.saliency.layers import Background
from moseg.tasks.saliency.support import unsupported_parallax


def explain_rigidly(flow: np.ndarray, motion: CameraMotion, params: SaliencyParams) -> Background:
    """Return the flow of a static scene that is nearest to the observed flow, and the residual.

    The residual has two parts: the flow across the epipolar line, which is 0 for static points, and the part of the
    flow along it whose depth is implausible, because the point would float above the ground or lie under it.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame.
    motion : CameraMotion
    params : SaliencyParams

    Returns
    -------
    Background
    """
    parts = split_flow(flow, motion)
    jump = _impossible_parallax(parts, params)
    left_x = parts.across * parts.towards_y + jump * parts.towards_x
    left_y = jump * parts.towards_y - parts.across * parts.towards_x
    background = flow - cv2.merge([left_x, left_y])
    return Background(background, np.sqrt(parts.across * parts.across + jump * jump))


def _impossible_parallax(parts: EpipolarFlow, params: SaliencyParams) -> np.ndarray:
    """Return the parallax float32 (y, x) that nothing static has: positive above the ground, negative under it."""
    inverse_depth = parts.along / parts.reach
    ground = fit_ground(inverse_depth, parts.reach, params)
    # A surface that leans towards the camera by the slope of the ground is not yet a jump.
    tolerance = params.support_slope * abs(ground.plane[2]) * parts.reach + params.support_noise
    if ground.share < params.ground_share:
        buried = np.zeros_like(inverse_depth)
    else:
        parallax = ground.inverse_depth(inverse_depth.shape) * parts.reach
        uneven = np.maximum(params.ground_relief * parallax, np.float32(params.ground_tolerance))
        buried = np.maximum(parallax - parts.along - uneven, 0)
    jump = unsupported_parallax(inverse_depth, parts.reach, buried, tolerance.astype(np.float32))
    return np.where((buried > 0) & (buried >= jump), -jump, jump)
