"""The logit of the motion network joined with that of saliency."""

import cv2
import numpy as np

from moseg.schemas.parameters import ForegroundParams, MotionNetworkParams
from moseg.tasks.saliency.logits import logit, motion_logit, probability


def join_evidence(
    saliency: np.ndarray, network: np.ndarray, params: MotionNetworkParams, foreground: ForegroundParams
) -> np.ndarray:
    """Return the saliency whose logit of motion is the weighted mean of saliency's and the network's.

    Parameters
    ----------
    saliency : float32 (y, x)
        0..1.
    network : float32 (grid y, grid x)
        Logit of `motion_network_logit`; enlarged to the size of `saliency`.
    params : MotionNetworkParams
    foreground : ForegroundParams
        Its `threshold` and `sharpness` convert saliency to a logit.

    Returns
    -------
    joined : float32 (y, x)
        0..1, to be converted by the same `threshold` and `sharpness`.
    """
    enlarged = cv2.resize(network, saliency.shape[::-1], interpolation=cv2.INTER_LINEAR)
    limit = np.float32(params.limit)
    own = np.clip(np.float32(params.gain) * enlarged, -limit, limit)
    seen = motion_logit(saliency, foreground.threshold, foreground.sharpness)
    joined = (1 - np.float32(params.share)) * seen + np.float32(params.share) * own
    return probability(joined / np.float32(foreground.sharpness) + logit(np.float32(foreground.threshold)))
