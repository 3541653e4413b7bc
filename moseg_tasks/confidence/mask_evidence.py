"""Evidence of the foreground for each object's mask in a frame: inside it, and just outside."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import ConfidenceParams
from moseg.tasks.proposals.holes import find_holes

_CERTAIN = 0.5
"""Probability from which a pixel moves rather than not."""
_UNDECIDED = 0.06
"""Mean probability from which a part may move or not; below, it is background."""
_MOST_OPEN = 0.3
"""Largest share of the outline of an undecided part on one side of the frame."""
_LEAST_KNOWN = 0.5
"""Least share of a mask that must not be undecided to speak for the rest."""


class MaskEvidence(NamedTuple):
    """Evidence for K objects in one frame, the background included; NaN for the background and without a pixel.

    Attributes
    ----------
    inside : float64 (K,)
        Mean probability to move of the object's pixels, but for parts in which it is low, though not near 0, and which
        the others surround: neither motion nor colour says much there, as in plain clothes. If these are more than half
        of the object, they count too.
    enclosed : float64 (K,)
        Share of the probability in the object and around it that the object covers: 1 if nothing moves around it.
    """

    inside: np.ndarray
    enclosed: np.ndarray


def mask_evidence(
    labels: np.ndarray, foreground: np.ndarray, num_objects: int, params: ConfidenceParams
) -> MaskEvidence:
    """Compare the objects of a frame with the probability of each pixel to move.

    What moves around an object and is no object may be a part of it that is missing.

    Parameters
    ----------
    labels : integer (y, x)
        Objects, 0 = background; 0..num_objects - 1.
    foreground : float32 (y, x)
        Probability to move, on the same grid.
    num_objects : int
        The background included.
    params : ConfidenceParams
        `reach` is how far around an object parts of it are sought.
    """
    counts = np.bincount(labels.ravel(), minlength=num_objects)
    sums = np.bincount(labels.ravel(), foreground.ravel(), num_objects)
    certain = np.where(foreground >= _CERTAIN, labels, 0)
    evidence = MaskEvidence(*np.full((2, num_objects), np.nan))
    free = np.where(labels == 0, foreground, 0)
    for index in np.flatnonzero(counts[1:]) + 1:
        mask = labels == index
        around = _sum_around(mask, free, params.reach * np.sqrt(counts[index]))
        evidence.inside[index] = _mean_inside(mask, certain == index, foreground)
        evidence.enclosed[index] = (sums[index] + params.prior) / (sums[index] + around + params.prior)
    return evidence


def _mean_inside(mask: np.ndarray, certain: np.ndarray, foreground: np.ndarray) -> float:
    """Return the mean probability in a mask without the parts that its certain pixels leave undecided."""
    box = _box_around(mask, 1)
    mask, certain, foreground = mask[box], certain[box], foreground[box]
    known = mask.copy()
    for hole in find_holes(certain, at_border=True):
        is_low = foreground[hole.box][hole.inside].mean() < _UNDECIDED
        if hole.opening <= _MOST_OPEN and not is_low:
            known[hole.box] &= ~hole.inside
    if np.count_nonzero(known) < _LEAST_KNOWN * np.count_nonzero(mask):
        known = mask
    return float(foreground[known].mean())


def _sum_around(mask: np.ndarray, values: np.ndarray, reach: float) -> float:
    """Return the sum of values within `reach` px of a mask."""
    box = _box_around(mask, int(np.ceil(reach)) + 1)
    # Distance to the nearest pixel of the mask; dilation by a large disc takes far longer.
    distance = cv2.distanceTransform((~mask[box]).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return float(values[box][distance <= reach].sum())


def _box_around(mask: np.ndarray, margin: int) -> tuple[slice, slice]:
    """Return the rows and columns of a mask that is not empty, with a margin inside the frame, px."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    first, last = (rows[0], columns[0]), (rows[-1], columns[-1])
    return tuple(slice(max(int(a) - margin, 0), int(b) + margin + 1) for a, b in zip(first, last, strict=True))
