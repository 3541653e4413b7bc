"""Labels of pixels that are sure to move or to be static."""

import cv2
import numpy as np

from moseg.schemas.parameters import VideoNetworkParams

STATIC, MOVING, IGNORED = 0, 1, 2
"""Labels of pixels; what is not sure is ignored."""


def sure_labels(
    foreground: np.ndarray,
    objects: np.ndarray,
    proof: np.ndarray,
    misfit: np.ndarray,
    params: VideoNetworkParams,
) -> np.ndarray | None:
    """Label the pixels of which motion says for certain what they are.

    Parameters
    ----------
    foreground : float16 or float32 (T, y, x)
        Probability to move, 0..1.
    objects : bool (T, y, x)
        Pixels of the components that are kept.
    proof : float16 or float32 (T, y, x)
        Photometric proof of motion, nats.
    misfit : float16 or float32 (T, y, x)
        Accumulated misfit to the own motion of what moves, ``log(1 + (d / s)^2)``: large for water, spray and shadows.
    params : VideoNetworkParams

    Returns
    -------
    labels : uint8 (T, y, x) or None
        `MOVING`, `STATIC` or `IGNORED`; None if nothing is sure to move or nothing is static.
    """
    window = cv2.getStructuringElement(cv2.MORPH_RECT, (2 * params.near + 1,) * 2)
    near = np.stack([cv2.dilate(frame.astype(np.uint8), window) > 0 for frame in objects])
    likely = (foreground > params.sure_moving) & near
    if not likely.any():
        return None
    certain = float(np.percentile(proof[likely].astype(np.float32), params.proof_percentile))
    moving = likely & (proof > params.proof_share * certain) & (misfit < np.log1p(params.max_deviation**2))
    static = foreground < params.sure_static
    if certain < params.min_proof or not moving.any() or not static.any():
        return None
    labels = np.full(foreground.shape, IGNORED, np.uint8)
    labels[static] = STATIC
    labels[moving] = MOVING
    return labels
