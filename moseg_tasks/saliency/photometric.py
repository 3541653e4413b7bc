"""Photometric gate: suppression of pixels whose colour the background's motion explains."""

import cv2
import numpy as np

from moseg.tasks.saliency.grid import warp


def colour_error(frame: np.ndarray, other: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """Return the RMS over colour of |other(x + flow) - frame|.

    Parameters
    ----------
    frame, other : float32 (y, x, 3)
        Grey levels 0..255.
    flow : float32 (y, x, 2)
        px/frame, from `frame` to `other`.

    Returns
    -------
    error : float32 (y, x)
        Grey levels.
    """
    difference = cv2.subtract(warp(other, flow), frame)
    squared = cv2.multiply(difference, difference)
    return np.sqrt(cv2.transform(squared, np.full((1, frame.shape[2]), 1 / frame.shape[2], np.float32)))


def blur_error(error: np.ndarray, blur: float) -> np.ndarray:
    """Blur a colour error float32 (y, x) by a Gaussian of sigma `blur` px."""
    return cv2.GaussianBlur(error, (0, 0), blur, borderType=cv2.BORDER_REPLICATE)


def photometric_gate(error: np.ndarray, scale: float) -> np.ndarray:
    """Return 1 - exp(-(E / scale)^2), float32 (y, x) in 0..1, of the blurred colour error E."""
    return 1 - cv2.exp(-((error * np.float32(1 / scale)) ** 2))
