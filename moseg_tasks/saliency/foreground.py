"""Probability of each pixel to move on its own: evidence of motion, of colour and of coherence."""

import numpy as np

from moseg.schemas.parameters import ForegroundParams
from moseg.tasks.saliency.logits import motion_logit, probability


def foreground_probability(
    saliency: np.ndarray,
    reliability: np.ndarray,
    misfit: np.ndarray,
    colour: np.ndarray,
    usual_reliability: float,
    params: ForegroundParams,
    remembered: np.ndarray | None = None,
) -> np.ndarray:
    """Add the logits of saliency and colour, less those for water, leaves and other textures that move.

    Parameters
    ----------
    saliency : float32 (y, x)
        Accumulated saliency, 0..1.
    reliability : float32 (y, x)
        Accumulated consistency of the flow, 0..1.
    misfit : float32 (y, x)
        Accumulated misfit to the foreground's own motion, ``log(1 + (d / s)^2)``.
    colour : float32 (y, x)
        Log ratio of colours.
    usual_reliability : float
        Mean consistency of the flow of what moves in these frames. Only lower consistency is
        penalised, so that blurred limbs are kept.
    params : ForegroundParams
    remembered : float32 (y, x), optional
        Logit of the remembered odds of motion, which replaces that of the saliency where it is greater.

    Returns
    -------
    probability : float32 (y, x)
        0..1.
    """
    floor = np.float32(params.reliability_floor)
    unreliable = np.minimum(np.log((floor + reliability) / (floor + np.float32(usual_reliability))), 0)
    deviates = np.log1p(np.expm1(misfit) / np.float32(params.misfit_tolerance**2))
    motion = motion_logit(saliency, params.threshold, params.sharpness)
    if remembered is not None:
        motion = np.maximum(motion, remembered)
    return probability(
        motion
        + np.float32(params.colour_weight) * colour
        + np.float32(params.reliability_weight) * unreliable
        - np.float32(params.misfit_weight) * deviates
    )
