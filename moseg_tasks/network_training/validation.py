"""Validation: overlap of what a network finds with the labels."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
import torch

from moseg.tasks.motion_network.unet import MotionUNet
from moseg.tasks.network_training.batch import Batch
from moseg.tasks.network_training.learner import apply_network

_MIN_PIXELS = 20  # moving pixels of a sample that is scored by overlap


class Validation(NamedTuple):
    """Scores of a network at logit 0, percent.

    Attributes
    ----------
    J : float
        Mean intersection over union of the samples in which something moves; NaN without any.
    false_pixels : float
        Mean share of the pixels found in the others; NaN without any.
    """

    J: float
    false_pixels: float


@torch.no_grad()
def validate(network: MotionUNet, batches: Iterable[Batch]) -> Validation:
    """Score a network in its state of inference on batches with labels, all on one device."""
    overlaps, false = [], []
    for batch in batches:
        counted = batch.weight > 0
        maps = ((apply_network(network, batch.channels) > 0) & counted, (batch.label > 0.5) & counted, counted)
        for found, true, counts in zip(*(each.cpu().numpy() for each in maps), strict=True):
            if true.sum() > _MIN_PIXELS:
                overlaps.append((found & true).sum() / (found | true).sum())
            else:
                false.append(found.sum() / max(counts.sum(), 1))
    return Validation(*(100 * float(np.mean(each)) if each else float("nan") for each in (overlaps, false)))
