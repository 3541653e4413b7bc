"""Evidence of a trained network for the foreground, and its weight where the network spreads."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import VideoNetworkParams
from moseg.tasks.saliency.logits import logit, probability
from moseg.tasks.video_network.labels import IGNORED, STATIC

_MIN_SPREAD = 1e-3


class Outcome(NamedTuple):
    """Findings of a trained network in the frames that it was trained on.

    Attributes
    ----------
    centre : float
        Logit midway between a balance of the classes and a balance of the labelled pixels.
    spread : float
        Standard deviation of its logit.
    growth : float
        Area in which its logit is over the centre, relative to that of the objects.
    """

    centre: float
    spread: float
    growth: float


def measure_outcome(logits: np.ndarray, objects: np.ndarray, labels: np.ndarray) -> Outcome:
    """Measure the logits of some frames.

    Training with weighted classes favours the smaller one. The centre is midway between 0 and the logit over which as
    many of the labelled pixels lie as are labelled as moving: 0 spreads to what looks like the object, the other one
    finds little beyond the labels.

    Parameters
    ----------
    logits : float32 (T, y, x)
        Of the network.
    objects : bool (T, y, x)
        Pixels of the components that are kept.
    labels : uint8 (T, y, x)
        Of `sure_labels`.
    """
    labelled = labels != IGNORED
    balance = float(np.quantile(logits[labelled], (labels[labelled] == STATIC).mean())) if labelled.any() else 0.0
    centre = balance / 2
    spread = max(float(logits.std(dtype=np.float64)), _MIN_SPREAD)
    return Outcome(centre, spread, float((logits > centre).sum() / max(objects.sum(), 1)))


def network_weight(outcome: Outcome, params: VideoNetworkParams) -> float:
    """Return the weight of a network, which shrinks where it finds far more than what moves."""
    excess = outcome.growth / params.max_growth
    return params.weight / max(excess, 1.0) ** 2


def refine_foreground(
    foreground: np.ndarray, logits: np.ndarray, outcome: Outcome, params: VideoNetworkParams
) -> np.ndarray:
    """Add the centred, scaled and limited logit of the network to that of the foreground.

    Parameters
    ----------
    foreground : float32 (y, x)
        Probability to move, 0..1.
    logits : float32 (y, x)
        Of the network.
    outcome : Outcome
    params : VideoNetworkParams
        Its `weight`, `caution`, `limit` and `max_growth` are read.

    Returns
    -------
    probability : float32 (y, x)
        0..1.
    """
    standard = (logits - np.float32(params.caution * outcome.centre)) / np.float32(outcome.spread)
    evidence = np.clip(standard, -params.limit, params.limit)
    return probability(logit(foreground) + np.float32(network_weight(outcome, params)) * evidence)
