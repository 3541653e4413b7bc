"""Roundness of what an image shows around a point: none on a straight edge, along which a tracker slips."""

import cv2
import numpy as np

_TINY = 1e-9
_SOBEL = 3  # aperture of the derivatives of the structure tensor, px


def roundness(image: np.ndarray, points: np.ndarray, side: int) -> np.ndarray:
    """Return the ratio of the eigenvalues of the structure tensor around points, float32 (N,).

    It is 0 on a straight edge, and on what is wholly plain.

    Parameters
    ----------
    image : uint8 (y, x)
    points : floating (N, 2)
        xy, px.
    side : int
        Of the patches, px.
    """
    if not len(points):
        return np.zeros(0, np.float32)
    x, y = np.clip(np.rint(points).astype(int), 0, np.array(image.shape[::-1]) - 1).T
    top, left = max(y.min() - side, 0), max(x.min() - side, 0)
    part = np.ascontiguousarray(image[top : y.max() + side + 1, left : x.max() + side + 1])
    of_points = cv2.cornerEigenValsAndVecs(part, side, _SOBEL)[y - top, x - left, :2]
    return of_points.min(axis=1) / np.maximum(of_points.max(axis=1), np.float32(_TINY))
