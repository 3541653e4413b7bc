"""Conversion between probabilities and logits."""

import numpy as np

_NEAREST_TO_CERTAIN = 1e-4


def logit(probability: np.ndarray) -> np.ndarray:
    """Return log(p / (1 - p)), float32, of `probability` clipped slightly away from 0 and 1."""
    clipped = np.clip(probability.astype(np.float32), _NEAREST_TO_CERTAIN, 1 - _NEAREST_TO_CERTAIN)
    return np.log(clipped / (1 - clipped))


def probability(logit: np.ndarray) -> np.ndarray:
    """Return 1 / (1 + exp(-x)), float32."""
    # Below a logit of -88 the exponential is infinite and the probability correctly 0.
    with np.errstate(over="ignore"):
        return 1 / (1 + np.exp(-logit))


def motion_logit(saliency: np.ndarray, threshold: float, sharpness: float) -> np.ndarray:
    """Return the logit float32 of the probability to move: `sharpness` (logit(`saliency`) - logit(`threshold`))."""
    return np.float32(sharpness) * (logit(saliency) - logit(np.float32(threshold)))
