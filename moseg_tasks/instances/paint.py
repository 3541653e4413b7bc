"""Masks that may overlap as one map of labels."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError


class Painted(NamedTuple):
    """A label map and the masks of its labels.

    Attributes
    ----------
    labels : uint16 (y, x)
        Objects 1 to m, best score first; 0 = background.
    order : intp (m,)
        Index of the mask of each object.
    """

    labels: np.ndarray
    order: np.ndarray


def paint_instances(masks: np.ndarray, scores: np.ndarray, min_area: float = 0.0) -> Painted:
    """Give each pixel to one object.

    Where masks overlap the pixel gets the label of the smallest: a small object in a large one's mask is in front of it
    or was detected separately, and the large one stays visible around it. A mask with too few pixels left is dropped.

    Parameters
    ----------
    masks : bool (n, y, x)
    scores : floating (n,)
        Of equal scores, the first is better.
    min_area : float
        Minimal area left of an object, share of the frame; always at least one pixel.

    Raises
    ------
    InputError
        There is not one score for each mask, or there are more masks than labels.
    """
    if np.shape(scores) != masks.shape[:1]:
        raise InputError("not one score for each mask", got=np.shape(scores), expected=masks.shape[:1])
    max_label = np.iinfo(np.uint16).max
    if len(masks) > max_label:
        raise InputError("more masks than labels", got=len(masks), expected=f"at most {max_label}")
    ranked = np.argsort(-np.asarray(scores), kind="stable")
    areas = np.count_nonzero(masks, axis=(1, 2))[ranked]
    labels = np.zeros(masks.shape[1:], np.uint16)
    # The largest first; of equal areas the better last, so that it is on top.
    for rank in np.lexsort((-np.arange(len(ranked)), -areas)):
        labels[masks[ranked[rank]]] = rank + 1
    left = np.bincount(labels.ravel(), minlength=len(ranked) + 1)[1:]
    is_seen = (left > 0) & (left >= min_area * labels.size)
    renumbered = np.concatenate([[0], np.cumsum(is_seen) * is_seen]).astype(np.uint16)
    return Painted(renumbered[labels], ranked[is_seen])
