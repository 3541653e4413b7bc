"""Histograms of a section's moving and static colours, and the consistency of the flow of what moves."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import AppearanceParams, ForegroundParams
from moseg.tasks.saliency.logits import motion_logit, probability


class ColourCount(NamedTuple):
    """Weighted counts over frames; counts of several runs of frames add up.

    Attributes
    ----------
    moving, static : float64 (bin,)
        Weight of the colours of what moves and of the background.
    reliability : float
        Summed consistency of the flow of what is salient.
    weight : float
        Weight of that sum.
    """

    moving: np.ndarray
    static: np.ndarray
    reliability: float
    weight: float


def count_colours(
    bins: np.ndarray,
    strict: np.ndarray,
    reliability: np.ndarray,
    misfit: np.ndarray,
    params: AppearanceParams,
    foreground: ForegroundParams,
) -> ColourCount:
    """Colours of one frame, each pixel weighted by how surely it moves or is static.

    Colours are only learnt from what moves as one and consistently: otherwise moving water would teach its colour.

    Parameters
    ----------
    bins : uint16 (y, x)
        Of `colour_bins`.
    strict : float32 (y, x)
        Accumulated strict saliency, 0..1.
    reliability : float32 (y, x)
        Accumulated consistency of the flow, 0..1.
    misfit : float32 (y, x)
        Accumulated misfit to the own motion.
    params : AppearanceParams
    foreground : ForegroundParams
        Its `threshold` and `sharpness` are read.

    Returns
    -------
    ColourCount
    """
    logit = motion_logit(strict, foreground.threshold, foreground.sharpness)
    moves = probability(logit - np.float32(params.misfit_weight) * misfit)
    moving = moves**params.moving_sharpness * reliability**2
    unreliable = np.float32(params.unreliable_static) * (1 - reliability)
    static = np.maximum((1 - moves) ** params.static_sharpness, unreliable)
    size = params.levels**3
    salient = strict > foreground.threshold
    core = probability(logit[salient]) ** params.moving_sharpness
    return ColourCount(
        np.bincount(bins.ravel(), moving.ravel(), size),
        np.bincount(bins.ravel(), static.ravel(), size),
        float(core @ reliability[salient]),
        float(core.sum()),
    )
