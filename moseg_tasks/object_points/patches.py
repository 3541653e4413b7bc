"""Patches around points: how well those of two frames correlate, and their contrast."""

import cv2
import numpy as np

_TINY = 1e-9
_AT_ONCE = 1 << 14  # OpenCV samples at most 32,766 rows of a map


def correlate_patches(
    image0: np.ndarray, points0: np.ndarray, image1: np.ndarray, points1: np.ndarray, side: int
) -> np.ndarray:
    """Return the normalised cross-correlation of patches around points of two images, float32 (N,), at most 1.

    Parameters
    ----------
    image0, image1 : uint8 (y, x)
    points0, points1 : float32 (N, 2)
        xy, px; linear between pixels.
    side : px.
    """
    correlation = np.zeros(len(points0), np.float32)
    for first in range(0, len(points0), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        patches0, patches1 = _centred(image0, points0[part], side), _centred(image1, points1[part], side)
        energy = np.square(patches0).sum(axis=1) * np.square(patches1).sum(axis=1)
        correlation[part] = (patches0 * patches1).sum(axis=1) / np.sqrt(energy + np.float32(_TINY))
    return correlation


def contrast(image: np.ndarray, points: np.ndarray, side: int) -> np.ndarray:
    """Return the standard deviation of the patches around points, grey levels, float32 (N,).

    Parameters
    ----------
    image : uint8 (y, x)
    points : float32 (N, 2)
        xy, px.
    side : int
        px.
    """
    found = np.zeros(len(points), np.float32)
    for first in range(0, len(points), _AT_ONCE):
        part = slice(first, first + _AT_ONCE)
        found[part] = np.sqrt(np.square(_centred(image, points[part], side)).mean(axis=1))
    return found


def _centred(image: np.ndarray, points: np.ndarray, side: int) -> np.ndarray:
    """Return the patches around points less the mean of each, float32 (N, side * side)."""
    steps = np.arange(side, dtype=np.float32) - np.float32((side - 1) / 2)
    across, down = np.meshgrid(steps, steps)
    x, y = (points[:, axis, None] + step.ravel() for axis, step in enumerate((across, down)))
    patches = cv2.remap(image, x, y, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE).astype(np.float32)
    return patches - patches.mean(axis=1, keepdims=True)
