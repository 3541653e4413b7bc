"""Shi-Tomasi corners inside an object's mask."""

import cv2
import numpy as np

BLOCK_SIZE = 5
"""Side of the window of the structure tensor, px: between OpenCV's 3 and the tracker's window."""


def corner_response(gray: np.ndarray) -> np.ndarray:
    """The smaller eigenvalue of the structure tensor at local maxima, 0 elsewhere.

    Parameters
    ----------
    gray : uint8 (y, x)

    Returns
    -------
    response : float32 (y, x)

    References
    ----------
    J. Shi and C. Tomasi, Good features to track, CVPR 1994.
    """
    response = cv2.cornerMinEigenVal(gray, BLOCK_SIZE)
    return np.where(response == cv2.dilate(response, None), response, 0)


def strongest_corners(
    response: np.ndarray, mask: np.ndarray, num_points: int, *, quality: float, spacing: float, taken: np.ndarray
) -> np.ndarray:
    """The strongest corners of a mask that keep their distance to each other and to points already there.

    Parameters
    ----------
    response : float32 (y, x)
        Of `corner_response`.
    mask : bool (y, x)
    num_points : int
        Most corners returned.
    quality : float
        Least response, as a share of the mask's largest.
    spacing : float
        Least distance between points, px.
    taken : float32 (M, 2)
        xy of points already there, px.

    Returns
    -------
    points : float32 (P, 2)
        P <= num_points, strongest first.
    """
    inside = np.where(mask, response, 0)
    y, x = np.nonzero(inside > quality * inside.max(initial=0))
    order = np.argsort(-inside[y, x], kind="stable")
    candidates = np.stack([x, y], axis=1)[order].astype(np.float32)
    chosen = np.zeros((0, 2), dtype=np.float32)
    while len(candidates) and len(chosen) < num_points:
        ...
    return chosen
