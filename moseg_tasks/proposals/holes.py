"""Holes of objects that nothing proves to be background."""

from collections.abc import Iterator
from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import ComponentParams
from moseg.tasks.half_floats import to_float32
from moseg.tasks.saliency.consistency import NEXT, PREVIOUS
from moseg.tasks.saliency.photometric import colour_error


def fill_holes(
    labels: np.ndarray,
    foreground: np.ndarray,
    images: np.ndarray,
    flows: np.ndarray,
    residual_flows: np.ndarray,
    params: ComponentParams,
) -> np.ndarray:
    """Fill the holes of objects for which neither motion nor colour says much.

    A plain part of an object looks alike wherever it moves, so that its motion does not show: the background's motion
    explains its colours too. It remains undecided, and belongs to the object around it. What is seen through an object
    has the background's colours, and its probability to move is low.

    Parameters
    ----------
    labels : uint16 (T, h, w)
        Object of each pixel of the working grid; 0 = background.
    foreground : float16 or float32 (T, h, w)
        Probability to move, 0..1.
    images : uint8 (T, h, w, 3)
        RGB.
    flows, residual_flows : float32 (T, 2, h, w, 2)
        Flow to the previous and to the next frame, and the same less the background's, px/frame.
    params : ComponentParams

    Returns
    -------
    labels : uint16 (T, h, w)
        A hole that a single object surrounds is part of it if its mean probability is at least `hole_probability`, and
        the mean colour error that the background's motion leaves there at most `hole_error`.
    """
    filled = labels.copy()
    for t, objects in enumerate(labels):
        holes = [
            hole
            for hole in find_holes(objects)
            if to_float32(foreground[t][hole.box][hole.inside]).mean() >= params.hole_probability
        ]
        if not holes:
            continue
        errors = list(_errors(t, images, flows, residual_flows))
        if not errors:
            continue
        error = np.minimum.reduce(errors)
        for hole in holes:
            if error[hole.box][hole.inside].mean() <= params.hole_error:
                filled[t][hole.box][hole.inside] = hole.label
    return filled


class Hole(NamedTuple):
    """A hole of an object.

    Attributes
    ----------
    box : two of slice
        Rows and columns around it, with a margin of 1 px.
    inside : bool (rows, columns)
    label : int
        Of the object.
    """

    box: tuple[slice, slice]
    inside: np.ndarray
    label: int


def find_holes(objects: np.ndarray) -> Iterator[Hole]:
    """Yield the parts of the background uint16 (h, w) that a single object surrounds."""
    height, width = objects.shape
    count, parts, boxes, _ = cv2.connectedComponentsWithStats((objects == 0).astype(np.uint8), connectivity=4)
    cross = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))
    for part in range(1, count):
        x, y, columns, rows = (int(value) for value in boxes[part, :4])
        if not (x > 0 and y > 0 and x + columns < width and y + rows < height):
            continue
        box = slice(y - 1, y + rows + 1), slice(x - 1, x + columns + 1)
        inside = parts[box] == part
        around = np.unique(objects[box][(cv2.dilate(inside.astype(np.uint8), cross) > 0) & ~inside])
        if len(around) == 1:
            yield Hole(box, inside, int(around[0]))


def _errors(t: int, images: np.ndarray, flows: np.ndarray, residual_flows: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the colour error float32 (h, w) of the background's motion to each neighbour of frame `t` that there is."""
    for direction, other in ((PREVIOUS, t - 1), (NEXT, t + 1)):
        if 0 <= other < images.shape[0]:
            frame, neighbour = (images[each, :].astype(np.float32) for each in (t, other))
            yield colour_error(frame, neighbour, flows[t, direction] - residual_flows[t, direction])
