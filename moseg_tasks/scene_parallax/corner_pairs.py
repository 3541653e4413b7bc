"""Corners of a frame, tracked through the frames that follow it."""

from collections.abc import Iterable
from itertools import pairwise

import cv2
import numpy as np

from moseg.schemas.parameters import SceneParallaxParams, TrackParams
from moseg.tasks.tracks.lucas_kanade import follow_points

_BLOCK = 5  # px, side of the window of the structure tensor
_CONTRAST = 2.0
_TILES = (8, 8)
_BORDER = 6  # px


def follow_corners(images: Iterable[np.ndarray], params: SceneParallaxParams) -> tuple[np.ndarray, np.ndarray]:
    """Track the corners of the first frame to the last, frame by frame.

    Parameters
    ----------
    images : iterable of uint8 (y, x, 3)
        RGB frames of one size, two or more.
    params : SceneParallaxParams

    Returns
    -------
    points0, points1 : float64 (N, 2)
        xy in the first and the last frame, px; only corners that tracking back found again in every step.
    """
    tracking = TrackParams(
        window=params.window,
        pyramid_levels=params.pyramid_levels,
        forward_backward=params.forward_backward,
        border=_BORDER,
    )
    points0 = points1 = None
    for gray0, gray1 in pairwise(map(_equalise, images)):
        if points0 is None:
            points0 = points1 = _find_corners(gray0, params)
        points1, found = follow_points(gray0, gray1, points1, tracking)
        points0, points1 = points0[found], points1[found]
    return points0.astype(np.float64), points1.astype(np.float64)


def _find_corners(gray: np.ndarray, params: SceneParallaxParams) -> np.ndarray:
    """Return the strongest corners that are apart from each other: float32 (N, 2)."""
    corners = cv2.goodFeaturesToTrack(
        gray, params.num_corners, params.corner_quality, params.corner_spacing, blockSize=_BLOCK
    )
    return np.zeros((0, 2), np.float32) if corners is None else corners.reshape(-1, 2)


def _equalise(image: np.ndarray) -> np.ndarray:
    """Return the grey image uint8 (y, x) with local contrast equalised, so that dark parts have corners too."""
    return cv2.createCLAHE(_CONTRAST, _TILES).apply(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY))
