"""Identities of objects across sections that share frames."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import linear_sum_assignment

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.linking import LinkingParams


def count_overlaps(masks0: np.ndarray, masks1: np.ndarray, num_objects0: int, num_objects1: int) -> np.ndarray:
    """Count the pixels that each object of one section shares with each of the next, over their common frames.

    Parameters
    ----------
    masks0, masks1 : uint16 (frame, y, x)
        The common frames as labelled in each section; 0 = background.
    num_objects0, num_objects1 : int
        Objects of each section, visible in these frames or not.

    Returns
    -------
    counts : int64 (num_objects0 + 1, num_objects1 + 1)
        Row and column 0 are the background, so row and column sums are the areas.

    Raises
    ------
    InputError
        The frames differ in number or size.
    """
    if masks0.shape != masks1.shape:
        raise InputError("sections do not share these frames", got=masks1.shape, expected=masks0.shape)
    counts = np.zeros((num_objects0 + 1) * (num_objects1 + 1), np.int64)
    for frame0, frame1 in zip(masks0, masks1, strict=True):
        pairs = frame0.astype(np.int64) * (num_objects1 + 1) + frame1
        counts += np.bincount(pairs.ravel(), minlength=counts.size)
    return counts.reshape(num_objects0 + 1, num_objects1 + 1)


def link_sections(overlaps: Sequence[np.ndarray], num_objects: Sequence[int], params: LinkingParams) -> np.ndarray:
    """Return the identity in the sequence of each object of each section.

    Adjacent sections are matched one to one, maximising the summed IoU over their common frames. An object without a
    match in the previous section gets a new identity.

    Parameters
    ----------
    overlaps : sequence of int64 (num_objects[i] + 1, num_objects[i + 1] + 1)
        `count_overlaps` of sections i and i + 1.
    num_objects : sequence of int
        Objects of each section.
    params : LinkingParams

    Returns
    -------
    identity : uint16 (section, maximal number of objects of a section + 1)
        0 for the background (column 0) and past a section's last object.

    Raises
    ------
    InputError
        The counts do not fit the sections.
    """
    expected = [(a + 1, b + 1) for a, b in pairwise(num_objects)]
    if [np.shape(counts) for counts in overlaps] != expected:
        raise InputError(
            "overlaps do not fit the sections", got=[np.shape(counts) for counts in overlaps], expected=expected
        )
    identity = np.zeros((len(num_objects), max(num_objects, default=0) + 1), np.uint16)
    used = 0
    for section, count in enumerate(num_objects):
        if section:
            for object0, object1 in match_objects(overlaps[section - 1], params.min_iou):
                identity[section, object1] = identity[section - 1, object0]
        for label in range(1, count + 1):
            if identity[section, label] == 0:
                used += 1
                identity[section, label] = used
    return identity


def match_objects(counts: np.ndarray, min_iou: float) -> list[tuple[int, int]]:
    """Return the pairs of labels of the assignment with the largest summed IoU, without those under `min_iou`.

    Parameters
    ----------
    counts : int64 (num_objects0 + 1, num_objects1 + 1)
        Of `count_overlaps`.
    min_iou : float
    """
    shared = counts[1:, 1:].astype(np.float64)
    union = counts[1:].sum(axis=1)[:, None] + counts[:, 1:].sum(axis=0)[None, :] - shared
    iou = shared / np.maximum(union, 1)
    iou[iou < min_iou] = 0
    return [(int(i) + 1, int(j) + 1) for i, j in zip(*linear_sum_assignment(-iou), strict=True) if iou[i, j] > 0]
