"""Motion of the background over pairs of frames: whether the camera moves."""

from collections.abc import Sequence

import cv2
import numpy as np

from moseg.schemas.parameters import FlowParams, SaliencyParams
from moseg.tasks.flow.dis import estimate_flow
from moseg.tasks.frame_grid import reduced_shape, resample
from moseg.tasks.saliency.background import affine_flow, fit_background

_SIDE = 213
"""Longer side of the frames between which motion is estimated, px."""
_FLOW, _FIT = FlowParams(preset="fast", search_side=16, coarse_side=0), SaliencyParams()


def camera_motions(images: Sequence[np.ndarray], following: Sequence[np.ndarray]) -> np.ndarray:
    """Return the median length of the background's motion from each frame to the one after it.

    Parameters
    ----------
    images, following : sequences of uint8 (y, x, 3)
        RGB frames of one size.

    Returns
    -------
    float64 (pair,)
        As a share of the frame's longer side.
    """
    return np.array([_motion(*pair) for pair in zip(images, following, strict=True)])


def _motion(*pair: np.ndarray) -> float:
    grid = reduced_shape(pair[0].shape[:2], _SIDE)
    flow = estimate_flow(*(resample(image, grid) for image in pair), _FLOW)
    background = affine_flow(fit_background(flow, _FIT), flow.shape[:2])
    return float(np.median(cv2.magnitude(background[..., 0], background[..., 1]))) / max(grid)
