"""Loss of logits against labels."""

import torch
from torch import Tensor
from torch.nn import functional

_MIN_PIXELS = 20  # moving pixels of a sample for which an overlap is counted


def label_loss(logit: Tensor, label: Tensor, weight: Tensor, smoothing: float, overlap: float) -> Tensor:
    """Return the cross-entropy plus `overlap` times one minus the soft intersection over union, both of mean samples.

    Parameters
    ----------
    logit, label, weight : float32 (sample, y, x)
        Labels are shares 0..1.
    smoothing : float
        Labels are drawn in from 0 and 1 by this much for the cross-entropy.
    overlap : float
        Weight; samples in which next to nothing moves have no overlap.
    """
    target = label * (1 - 2 * smoothing) + smoothing
    entropy = functional.binary_cross_entropy_with_logits(logit, target, reduction="none")
    entropy = (entropy * weight).sum((1, 2)) / weight.sum((1, 2)).clamp(min=1)
    found, true = torch.sigmoid(logit) * weight, label * weight
    shared, area = (found * true).sum((1, 2)), true.sum((1, 2))
    missed = 1 - (shared + 1) / (found.sum((1, 2)) + area - shared + 1)
    return entropy.mean() + overlap * (missed * (area > _MIN_PIXELS)).mean()
