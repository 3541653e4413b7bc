"""Estimates how sure and how complete masks are, calibrated on scenes with ground truth."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import ConfidenceParams
from moseg.tasks.confidence.mask_evidence import MaskEvidence

_LEAST = 0.005  # evidence is never nearer to 0 or to 1


class Confidence(NamedTuple):
    """Estimates for K objects in one frame; NaN where an object has no evidence.

    Attributes
    ----------
    sure : float64 (K,)
        Share of the mask that moves on its own: its expected precision.
    complete : float64 (K,)
        Share of the object that the mask covers: its expected recall.
    """

    sure: np.ndarray
    complete: np.ndarray


def estimate_confidence(evidence: MaskEvidence, params: ConfidenceParams) -> Confidence:
    """Estimate precision and recall from the evidence: a logistic curve of the logit of each (Platt scaling).

    References
    ----------
    J. Platt, Probabilistic outputs for support vector machines, 1999.
    """
    sure = _logistic(params.sure_offset + params.sure_slope * _logit(evidence.inside))
    complete = _logistic(params.complete_offset + params.complete_slope * _logit(evidence.enclosed))
    return Confidence(sure, complete)


def _logit(share: np.ndarray) -> np.ndarray:
    bounded = np.clip(share, _LEAST, 1 - _LEAST)
    return np.log(bounded / (1 - bounded))


def _logistic(value: np.ndarray) -> np.ndarray:
    return 1 / (1 + np.exp(-value))
