"""A camera at rest: what is at two opposite borders of the frame is exactly where it was."""

import cv2
import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.background import AffineMotion
from moseg.tasks.saliency.grid import vector_length
from moseg.tasks.saliency.layers import Background

_MIN_TEXTURE = 0.1
"""Share of a border's pixels that must have texture: flow across plain walls shows nothing, nor does a single line."""


def is_at_rest(flow: np.ndarray, image: np.ndarray, params: SaliencyParams) -> bool:
    """Return whether the camera is at rest over a frame pair, however much of the frame moves.

    Someone at work before a tripod can fill most of the frame, and be most of what a fit sees. At both sides, or above
    and below, there is still some of the scene. A camera that moves leaves no two opposite borders at rest: one that
    turns or shifts moves both, ahead it moves all four.

    Parameters
    ----------
    flow : float32 (y, x, 2)
        px/frame.
    image : float32 (y, x, 3)
        RGB, 0..255.
    params : SaliencyParams
    """
    rests = vector_length(flow) < params.rest_motion
    level = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    has_texture = cv2.magnitude(*(cv2.Sobel(level, cv2.CV_32F, *order) / 8 for order in ((1, 0), (0, 1))))
    has_texture = has_texture > params.rest_gradient
    width = max(1, round(params.border_band * len(flow)))
    sides = (np.s_[:, :width], np.s_[:, -width:]), (np.s_[:width], np.s_[-width:])
    return any(all(_rests(rests[band], has_texture[band], params) for band in pair) for pair in sides)


def resting_background(flow: np.ndarray, params: SaliencyParams) -> Background:
    """Return a background without any motion, of which everything that moves is a residual."""
    motion = AffineMotion(np.zeros((3, 2)), np.zeros(2), params.affine_scale_floor)
    return Background(np.zeros_like(flow), vector_length(flow), motion, is_at_rest=True)


def _rests(rests: np.ndarray, has_texture: np.ndarray, params: SaliencyParams) -> bool:
    """Return whether enough of the pixels with texture are at rest, and there are enough of these."""
    textured = np.count_nonzero(has_texture)
    at_rest = np.count_nonzero(rests & has_texture)
    return textured >= _MIN_TEXTURE * has_texture.size and at_rest >= params.rest_share * textured
