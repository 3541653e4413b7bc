"""Memory of motion: what has moved, or will move, stays foreground while it rests or moves little.

The accumulated saliency is the mean of probabilities over a few frames: an object that rests for longer, or a foot
that stands while the body moves on, is lost. A mean of odds is dominated by the frames in which the surface clearly
moved. It therefore lasts longer, and one frame of a false alarm in many does not suffice.
"""

import numpy as np

from moseg.schemas.parameters import ForegroundParams, MotionMemoryParams
from moseg.tasks.saliency.logits import motion_logit

_NO_ODDS = 1e-4  # bounds the logarithm; smaller odds are certainly static


def motion_odds(saliency: np.ndarray, params: MotionMemoryParams, foreground: ForegroundParams) -> np.ndarray:
    """Return the odds of motion of each pixel of a frame, float32 (y, x), at most `max_odds`.

    Parameters
    ----------
    saliency : float32 (y, x)
        Accumulated saliency, 0..1.
    params : MotionMemoryParams
    foreground : ForegroundParams
        Its `threshold` and `sharpness` are read.
    """
    logit = motion_logit(saliency, foreground.threshold, foreground.sharpness)
    return np.exp(np.minimum(logit, np.float32(np.log(params.max_odds))))


def remembered_logit(odds: np.ndarray) -> np.ndarray:
    """Return the logit float32 (y, x) of `odds` float32 (y, x), the mean of both passes, not below that of 1e-4."""
    return np.log(odds + np.float32(_NO_ODDS))
