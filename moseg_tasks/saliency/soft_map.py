"""From residual motion to a soft map in 0..1."""

import cv2
import numpy as np

from schemas.parameters import SaliencyParams


def soft_map(residual: np.ndarray, background_speed: np.ndarray, params: SaliencyParams) -> np.ndarray:
    """r^2 / (r^2 + tau^2) of the blurred residual r.

    Otsu's threshold alone finds two classes in any frame; the floors keep a frame without movers empty.

    Parameters
    ----------
    residual, background_speed : float32 (y, x)
        Residual motion and length of the background's motion, px/frame.
    params : SaliencyParams

    Returns
    -------
    saliency : float32 (y, x)
        0..1, 1/2 where the residual equals tau.
    """
    floor = max(
        _otsu(residual, params.otsu_percentile), params.floor, params.floor_medians * float(np.median(residual))
    )
    tau = np.maximum(floor, params.floor_motion * background_speed)
    squared = cv2.GaussianBlur(residual, (0, 0), params.residual_blur) ** 2
    return squared / (squared + tau**2)


def _otsu(residual: np.ndarray, percentile: float) -> float:
    """Otsu's threshold of the square root of the residual, as a residual; 0 where all are equal."""
    root = np.sqrt(residual)
    top = float(np.percentile(root, percentile))
    if top == 0:
        return 0.0
    levels = np.minimum(root * (255 / top), 255).astype(np.uint8)
    level, _ = cv2.threshold(levels, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    return (level * top / 255) ** 2
