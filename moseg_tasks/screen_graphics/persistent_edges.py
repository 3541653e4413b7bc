"""Edges that are in almost all frames of a video at the same pixels."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import ScreenGraphicsParams

_SOBEL = 8  # weights of one side of the operator, by which it is divided


class PersistentEdges(NamedTuple):
    """Persistent edges of a video.

    Attributes
    ----------
    gradient : float32 (y, x, 2)
        Median over the frames, xy, grey levels per px.
    is_persistent : bool (y, x)
    share : float
        Of the edges that a frame has on average, 0..1.
    """

    gradient: np.ndarray
    is_persistent: np.ndarray
    share: float


def persistent_edges(levels: np.ndarray, params: ScreenGraphicsParams) -> PersistentEdges:
    """Find the pixels at which almost all frames have the same strong gradient.

    The median over time of the gradient is what a scene that moves leaves of a mark in front of it.

    Parameters
    ----------
    levels : uint8 (frame, y, x)
        Grey levels.
    params : ScreenGraphicsParams

    Returns
    -------
    PersistentEdges

    References
    ----------
    Dekel, Rubinstein, Liu, Freeman, "On the Effectiveness of Visible Watermarks", CVPR 2017, section 3.1.
    """
    gradients = np.stack([[cv2.Sobel(each, cv2.CV_16S, *order) for order in ((1, 0), (0, 1))] for each in levels])
    middle = len(levels) // 2
    median = np.partition(gradients, middle, axis=0)[middle].astype(np.float32) / _SOBEL
    strength = cv2.magnitude(*median)
    agreeing, strong = np.zeros(strength.shape), 0
    for gradient in gradients:
        gradient = gradient.astype(np.float32) / _SOBEL
        agreeing += cv2.magnitude(*(gradient - median)) <= params.tolerance * strength + np.float32(params.noise)
        strong += np.count_nonzero(cv2.magnitude(*gradient) > params.min_gradient)
    persistent = (strength > params.min_gradient) & (agreeing >= params.min_agreement * len(levels))
    share = np.count_nonzero(persistent) * len(levels) / max(strong, 1)
    return PersistentEdges(median.transpose(1, 2, 0), persistent, share)
