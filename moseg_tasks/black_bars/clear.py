"""Masks without what lies in black bars."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.black_bars import BlackBars


class InsideObjects(NamedTuple):
    """Objects of a section without their pixels in bars.

    Attributes
    ----------
    masks : uint16 (T, y, x)
        Object of each pixel, numbered 1.. in the order of `kept`; 0 = background.
    kept : intp (object,)
        The object that each was before, counted from 0.
    """

    masks: np.ndarray
    kept: np.ndarray


def clear_bars(masks: np.ndarray, bars: BlackBars) -> np.ndarray:
    """Return masks (..., y, x) with zeros in the bars."""
    inside = (..., *bars.picture(masks.shape[-2:]))
    cleared = np.zeros_like(masks)
    cleared[inside] = masks[inside]
    return cleared


def keep_inside(masks: np.ndarray, num_objects: int, bars: BlackBars) -> InsideObjects:
    """Clear the bars in the masks of a section, and drop the objects that lie nowhere else.

    Parameters
    ----------
    masks : uint16 (T, y, x)
        Object of each pixel, 1..num_objects; 0 = background.
    num_objects : int
        Objects without a pixel anywhere are among them; they stay.
    bars : BlackBars

    Returns
    -------
    InsideObjects
    """
    cleared = clear_bars(masks, bars)
    before, after = (np.bincount(each.ravel(), minlength=num_objects + 1)[1:] > 0 for each in (masks, cleared))
    kept = np.flatnonzero(after | ~before)
    number = np.zeros(num_objects + 1, np.uint16)
    number[kept + 1] = np.arange(1, len(kept) + 1)
    return InsideObjects(number[cleared], kept)
