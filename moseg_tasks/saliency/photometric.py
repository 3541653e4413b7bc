"""Photometric gate: a pixel that the background's motion explains by colour does not move on its own."""

import cv2
import numpy as np

from moseg_tasks.saliency.grid import pixel_grid


def colour_error(frame: np.ndarray, other: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """RMS over colour of |other(x + flow) - frame|.

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
    position = pixel_grid(frame.shape[:2]) + flow
    moved = cv2.remap(other, position, None, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    difference = moved - frame
    return np.sqrt(np.einsum("yxc,yxc->yx", difference, difference) / frame.shape[2])


def photometric_gate(error: np.ndarray, blur: float, scale: float) -> np.ndarray:
    """1 - exp(-(E / scale)^2), float32 (y, x) in 0..1, of the colour error E under a Gaussian of sigma `blur` px."""
    smooth = cv2.GaussianBlur(error, (0, 0), blur, borderType=cv2.BORDER_REPLICATE)
    return 1 - np.exp(-((smooth / scale) ** 2))
