"""Areas of objects, and which of them are too small for the result."""

from collections.abc import Iterable

import numpy as np


def largest_areas(masks: np.ndarray) -> np.ndarray:
    """Return the largest share of a frame that each object covers, float64 (object,), 0..1, up to the last one seen.

    `masks` is uint16 (T, y, x), the objects of a section; 0 = background.
    """
    num_objects = int(masks.max(initial=0)) + 1
    largest = np.zeros(num_objects)
    for mask in masks:
        counts = np.bincount(mask.ravel(), minlength=num_objects)
        np.maximum(largest, counts / mask.size, out=largest)
    return largest


def small_objects(sections: Iterable[tuple[np.ndarray, np.ndarray]], min_area: float) -> frozenset[int]:
    """Return the objects of a sequence whose largest area is below `min_area`.

    Parameters
    ----------
    sections : iterable of (int (object,), float64 (object,))
        What each object of a section is called in the sequence, and the largest areas of those that are seen; several
        may be one.
    min_area : float
        Share of the frame.
    """
    largest: dict[int, float] = {}
    for objects, areas in sections:
        for each, area in zip(objects.tolist(), areas.tolist(), strict=False):
            largest[each] = max(largest.get(each, 0.0), area)
    return frozenset(each for each, area in largest.items() if area < min_area)
