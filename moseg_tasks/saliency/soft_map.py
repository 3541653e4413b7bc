"""Conversion of residual motion to a soft map in 0..1."""

import cv2
import numpy as np

from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.saliency.layers import typical_residual


def soft_map(
    residual: np.ndarray,
    background_speed: np.ndarray,
    params: SaliencyParams,
    is_rigid: bool,
    is_at_rest: bool = False,
) -> np.ndarray:
    """Return r^2 / (r^2 + tau^2) of the blurred residual r.

    The floors keep a frame without movers empty. Layers leave a residual above them wherever depth varies, which Otsu's
    threshold of the whole frame suppresses. A rigid background leaves none, and tau follows the nearby residual
    instead: flow is smooth across an object's outline, which lies where the residual falls to a share of its value
    inside. A background at rest leaves none either: there the lower of both counts, so that a small, slow thing is seen
    beside a large, fast one.

    Parameters
    ----------
    residual, background_speed : float32 (y, x)
        Residual motion and length of the background's motion, px/frame.
    params : SaliencyParams
    is_rigid : bool
        Whether the background is a rigid scene, else layers.
    is_at_rest : bool, optional
        Whether it is at rest. Then most of the frame may move, and its typical residual says nothing of the background.

    Returns
    -------
    saliency : float32 (y, x)
        0..1, 1/2 where the residual equals tau.
    """
    smooth = cv2.GaussianBlur(residual, (0, 0), params.residual_blur)
    typical = 0.0 if is_at_rest else typical_residual(residual, params.border_band)
    floor = max(params.floor, params.floor_medians * typical)
    whole = np.inf if is_rigid else np.float32(_otsu(residual, params.otsu_percentile))
    nearby = np.inf
    if is_rigid or is_at_rest:
        nearby = params.outline_share * _nearby_peak(smooth, params.outline_reach)
    tau = np.maximum(params.floor_motion * background_speed, np.float32(floor))
    tau = np.maximum(tau, np.minimum(whole, nearby))
    squared = smooth * smooth
    return squared / (squared + tau * tau)


def _nearby_peak(residual: np.ndarray, reach: int) -> np.ndarray:
    """Return the maximal residual within `reach` px, averaged over the same window."""
    side = 2 * reach + 1
    return cv2.blur(cv2.dilate(residual, np.ones((side, side), np.uint8)), (side, side))


def _otsu(residual: np.ndarray, percentile: float) -> float:
    """Return Otsu's threshold of the residual's square root, as a residual; 0 where all are equal."""
    root = np.sqrt(residual)
    top = float(np.percentile(root[::2, ::2], percentile))
    if top == 0:
        return 0.0
    levels = np.minimum(root * np.float32(255 / top), 255).astype(np.uint8)
    level, _ = cv2.threshold(levels, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    return (level * top / 255) ** 2
