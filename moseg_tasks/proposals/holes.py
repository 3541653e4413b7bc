"""Holes of objects that nothing proves to be background."""

from collections.abc import Iterator
from functools import cache
from typing import NamedTuple

import cv2
import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from moseg.schemas.parameters import ComponentParams
from moseg.tasks.half_floats import to_float32
from moseg.tasks.saliency.consistency import NEXT, PREVIOUS
from moseg.tasks.saliency.photometric import colour_error

_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))


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


def find_holes(objects: np.ndarray, border_share: float = 0.0) -> Iterator[Hole]:
    """Yield the parts of the background uint16 (h, w) that a single object surrounds.

    With `border_share`, also those that are open to a single side of the frame, by at most this share of their outline.
    """
    height, width = objects.shape
    count, parts, boxes, _ = cv2.connectedComponentsWithStats((objects == 0).astype(np.uint8), connectivity=4)
    for part in range(1, count):
        x, y, columns, rows = (int(value) for value in boxes[part, :4])
        open_sides = [x == 0, y == 0, x + columns == width, y + rows == height]
        if sum(open_sides) > (border_share > 0):
            continue
        box = slice(max(y - 1, 0), y + rows + 1), slice(max(x - 1, 0), x + columns + 1)
        inside = parts[box] == part
        # Beyond the frame there is nothing around it.
        outline = (cv2.dilate(inside.astype(np.uint8), _CROSS) > 0) & ~inside
        around = np.unique(objects[box][outline])
        if len(around) != 1:
            continue
        if any(open_sides):
            first, last = inside[:, 0], inside[:, -1]
            top, bottom = inside[0], inside[-1]
            opening = (first, top, last, bottom)[open_sides.index(True)].sum()
            if opening > border_share * (opening + outline.sum()):
                continue
        yield Hole(box, inside, int(around[0]))


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
    has the background's colours, and its probability to move is low. The plainer a hole is, the less tells it apart,
    and the lower a probability leaves it undecided.

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
        A hole that a single object surrounds, but for a share `hole_border` of its outline on one side of the frame, is
        part of it if the mean colour error that the background's motion leaves there is at most `hole_error`, and the
        mean probability at least `hole_probability` with that error, `hole_even_share` of this with none, and in
        proportion between. Holes of neighbouring frames that share a pixel are one hole, for which the medians of these
        means count.
    """
    filled = labels.copy()
    if params.hole_probability == 1:
        return filled

    @cache
    def colour_errors(t: int) -> np.ndarray | None:
        errors = list(_errors(t, images, flows, residual_flows))
        return np.minimum.reduce(errors) if errors else None

    for followed in _follow_holes(labels, params.hole_border):
        moves = np.median([_mean(foreground[t], hole) for t, hole in followed])
        if moves < params.hole_even_share * params.hole_probability:
            continue
        known = [(colour_errors(t), hole) for t, hole in followed if colour_errors(t) is not None]
        error = np.median([_mean(errors, hole) for errors, hole in known]) if known else np.inf
        if error > params.hole_error:
            continue
        evenness = 1 - error / params.hole_error if params.hole_error > 0 else 1
        if moves >= params.hole_probability * (1 - (1 - params.hole_even_share) * evenness):
            for t, hole in followed:
                filled[t][hole.box][hole.inside] = hole.label
    return filled


def _mean(values: np.ndarray, hole: Hole) -> float:
    """Return the mean of a map (h, w) over a hole."""
    return float(to_float32(values[hole.box][hole.inside]).mean())


def _follow_holes(labels: np.ndarray, border_share: float) -> list[list[tuple[int, Hole]]]:
    """Return the holes of objects in uint16 (T, h, w), each as its frames and its hole in each of them."""
    holes, edges = [], []
    before = np.full(labels.shape[1:], -1)
    for t, objects in enumerate(labels):
        now = np.full_like(before, -1)
        for hole in find_holes(objects, border_share):
            now[hole.box][hole.inside] = len(holes)
            overlaps = np.unique(before[hole.box][hole.inside])
            edges += [(len(holes), other) for other in overlaps if other >= 0 and holes[other][1].label == hole.label]
            holes.append((t, hole))
        before = now
    rows, columns = np.array(edges, int).reshape(-1, 2).T
    graph = coo_array((np.ones(len(edges)), (rows, columns)), shape=(len(holes), len(holes)))
    count, group = connected_components(graph, directed=False)
    followed = [[] for _ in range(count)]
    for index, hole in zip(group, holes, strict=True):
        followed[index].append(hole)
    return followed


def _errors(t: int, images: np.ndarray, flows: np.ndarray, residual_flows: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the colour error float32 (h, w) of the background's motion to each neighbour of frame `t` that there is."""
    for direction, other in ((PREVIOUS, t - 1), (NEXT, t + 1)):
        if 0 <= other < images.shape[0]:
            frame, neighbour = (images[each, :].astype(np.float32) for each in (t, other))
            yield colour_error(frame, neighbour, flows[t, direction] - residual_flows[t, direction])
