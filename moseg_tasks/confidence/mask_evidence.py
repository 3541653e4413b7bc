"""Evidence of the foreground for each object's mask in a frame: inside it, and just outside."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import ConfidenceParams


class MaskEvidence(NamedTuple):
    """Evidence for K objects in one frame, the background included; NaN for the background and without a pixel.

    Attributes
    ----------
    inside : float64 (K,)
        Mean probability to move of the object's pixels.
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
    evidence = MaskEvidence(*np.full((2, num_objects), np.nan))
    free = np.where(labels == 0, foreground, 0)
    for index in np.flatnonzero(counts[1:]) + 1:
        around = _sum_around(labels == index, free, params.reach * np.sqrt(counts[index]))
        evidence.inside[index] = sums[index] / counts[index]
        evidence.enclosed[index] = (sums[index] + params.prior) / (sums[index] + around + params.prior)
    return evidence


def _sum_around(mask: np.ndarray, values: np.ndarray, reach: float) -> float:
    """Return the sum of values within `reach` px of a mask."""
    margin = int(np.ceil(reach)) + 1
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    box = tuple(slice(max(int(line[0]) - margin, 0), int(line[-1]) + margin + 1) for line in (rows, columns))
    # Distance to the nearest pixel of the mask; dilation by a large disc takes far longer.
    distance = cv2.distanceTransform((~mask[box]).astype(np.uint8), cv2.DIST_L2, cv2.DIST_MASK_5)
    return float(values[box][distance <= reach].sum())
