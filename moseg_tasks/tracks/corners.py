"""Shi-Tomasi corners inside an object's mask."""

import cv2
import numpy as np

from moseg.tasks.tracks.spacing import spaced_subset

BLOCK_SIZE = 5
"""Side of the window of the structure tensor, px: between OpenCV's default of 3 and the tracker's window."""


def texture_strength(gray: np.ndarray) -> np.ndarray:
    """Return the smaller eigenvalue of the structure tensor of a uint8 image (y, x): float32 (y, x).

    References
    ----------
    J. Shi and C. Tomasi, Good features to track, CVPR 1994.
    """
    return cv2.cornerMinEigenVal(gray, BLOCK_SIZE)


def strongest_corners(
    texture: np.ndarray, mask: np.ndarray, num_points: int, *, spacing: float, taken: np.ndarray
) -> np.ndarray:
    """Return the strongest corners of a mask that are apart from each other and from existing points.

    Parameters
    ----------
    texture : float32 (y, x)
        Of `texture_strength`; its local maxima are the corners.
    mask : bool (y, x)
    num_points : int
        Maximal number of corners.
    spacing : float
        Minimal distance between points, px.
    taken : float32 (M, 2)
        xy of existing points, px.

    Returns
    -------
    points : float32 (P, 2)
        P <= num_points, strongest first.
    """
    y, x = np.nonzero(mask & (texture > 0) & (texture == cv2.dilate(texture, None)))
    order = np.argsort(-texture[y, x], kind="stable")
    candidates = np.stack([x, y], axis=1)[order].astype(np.float32)
    return spaced_subset(candidates, num_points, spacing, taken)
