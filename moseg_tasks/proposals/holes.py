"""Holes of objects that nothing proves to be background."""

from collections.abc import Callable, Iterator
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
_APART = 2
"""Distance of the pixels whose colours tell how plain a hole is, px of the working grid."""
_SHARED = 0.5
"""Share of the smaller of two holes in successive frames that both have, if they are one hole."""


class Hole(NamedTuple):
    """A hole of an object.

    Attributes
    ----------
    box : two of slice
        Rows and columns around it, with a margin of 1 px inside the frame.
    inside : bool (rows, columns)
    label : int
        Of the object.
    opening : float
        Share of its outline on one side of the frame, 0..1; the rest is the object's.
    """

    box: tuple[slice, slice]
    inside: np.ndarray
    label: int
    opening: float


def find_holes(objects: np.ndarray, at_border: bool = False) -> Iterator[Hole]:
    """Yield the parts of the background uint16 (h, w) that a single object surrounds.

    With `at_border`, also those that touch one side of the frame, and a single object otherwise.
    """
    height, width = objects.shape
    count, parts, boxes, _ = cv2.connectedComponentsWithStats((objects == 0).astype(np.uint8), connectivity=4)
    for part in range(1, count):
        x, y, columns, rows = (int(value) for value in boxes[part, :4])
        touches = [y == 0, y + rows == height, x == 0, x + columns == width]
        if sum(touches) > int(at_border):
            continue
        box = slice(max(y - 1, 0), y + rows + 1), slice(max(x - 1, 0), x + columns + 1)
        inside = parts[box] == part
        outline = (cv2.dilate(inside.astype(np.uint8), _CROSS) > 0) & ~inside
        around = np.unique(objects[box][outline])
        if len(around) != 1:
            continue
        sides = inside[0], inside[-1], inside[:, 0], inside[:, -1]
        open_pixels = sum(int(side.sum()) for side, touched in zip(sides, touches, strict=True) if touched)
        yield Hole(box, inside, int(around[0]), open_pixels / (open_pixels + int(outline.sum())))


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
    has the background's colours, and its probability to move is low. The plainer a hole is, the less there is to decide
    by, and the lower a probability leaves it undecided.

    Holes of an object in successive frames are one hole if half of the smaller is in both. Of this hole, each figure
    below is the median over its frames of the mean over its pixels.

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
        A hole is part of the object if nothing else is around it but one side of the frame, at at most `hole_border` of
        its outline; if its probability is at least `hole_probability` where colours 2 px apart differ by
        `hole_roughness` or more, `hole_plain_share` of that where they are the same, and in proportion between; and if
        the colour error that the background's motion leaves there is at most `hole_error` from half of
        `hole_roughness` on, and more in proportion where it is plainer: in a plain hole, a background that is seen
        through it leaves none. With a `hole_probability` of 1, or a single frame, nothing is filled.
    """
    filled = labels.copy()
    if params.hole_probability == 1 or len(labels) == 1:
        return filled

    @cache
    def errors(t: int) -> np.ndarray:
        return np.minimum.reduce(list(_errors(t, images, flows, residual_flows)))

    for group in _group_holes(labels):
        if _usual(group, lambda t, hole: hole.opening) > params.hole_border:
            continue
        moves = _usual(group, lambda t, hole: float(to_float32(foreground[t][hole.box][hole.inside]).mean()))
        if moves < params.hole_plain_share * params.hole_probability:
            continue
        roughness = _usual(group, lambda t, hole: _roughness(images[t, :][hole.box], hole.inside))
        # NaN is rough: in a speck nothing is seen of that.
        evenness = max(1 - roughness / params.hole_roughness, 0) if roughness >= 0 else 0
        if moves < params.hole_probability * (1 - (1 - params.hole_plain_share) * evenness):
            continue
        error = _usual(group, lambda t, hole: float(errors(t)[hole.box][hole.inside].mean()))
        if error * min(2 * (1 - evenness), 1) <= params.hole_error:
            for t, hole in group:
                filled[t][hole.box][hole.inside] = hole.label
    return filled


def _usual(group: list[tuple[int, Hole]], figure: Callable[[int, Hole], float]) -> float:
    """Return the median over frames of a figure's mean over the pixels of the group's holes in each.

    Holes whose figure is NaN do not count; NaN if none does.
    """
    by_frame = {}
    for t, hole in group:
        by_frame.setdefault(t, []).append((figure(t, hole), hole.inside.sum()))
    means = []
    for holes in by_frame.values():
        figures, areas = np.array(holes, float).T
        known = ~np.isnan(figures)
        if known.any():
            means.append(np.average(figures[known], weights=areas[known]))
    return float(np.median(means)) if means else np.nan


def _roughness(image: np.ndarray, inside: np.ndarray) -> float:
    """Return the mean RMS over colour between pixels of a hole 2 px apart, grey levels; NaN where there are none.

    Parameters
    ----------
    image : uint8 (y, x, 3)
    inside : bool (y, x)
    """
    colours, found = image.astype(np.float32), []
    for first, second in ((np.s_[:-_APART], np.s_[_APART:]), (np.s_[:, :-_APART], np.s_[:, _APART:])):
        both = inside[first] & inside[second]
        found.append(np.sqrt(np.square(colours[first] - colours[second]).mean(axis=-1))[both])
    differences = np.concatenate(found)
    return float(differences.mean()) if len(differences) else np.nan


def _group_holes(labels: np.ndarray) -> list[list[tuple[int, Hole]]]:
    """Return the holes of objects in uint16 (T, h, w), and their frames, grouped over successive frames."""
    holes, areas, same = [], [], []
    before = np.full(labels.shape[1:], -1)
    for t, objects in enumerate(labels):
        now = np.full_like(before, -1)
        for hole in find_holes(objects, at_border=True):
            number, area = len(holes), int(hole.inside.sum())
            others, shared = np.unique(before[hole.box][hole.inside], return_counts=True)
            same += [
                (number, other)
                for other, pixels in zip(others.tolist(), shared.tolist(), strict=True)
                if other >= 0 and holes[other][1].label == hole.label and pixels >= _SHARED * min(area, areas[other])
            ]
            now[hole.box][hole.inside] = number
            holes.append((t, hole))
            areas.append(area)
        before = now
    rows, columns = np.array(same, int).reshape(-1, 2).T
    graph = coo_array((np.ones(len(same)), (rows, columns)), shape=(len(holes), len(holes)))
    count, group_of = connected_components(graph, directed=False)
    groups = [[] for _ in range(count)]
    for group, frame_and_hole in zip(group_of, holes, strict=True):
        groups[group].append(frame_and_hole)
    return groups


def _errors(t: int, images: np.ndarray, flows: np.ndarray, residual_flows: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the colour error float32 (h, w) of the background's motion to each neighbour of frame `t` that there is."""
    for direction, other in ((PREVIOUS, t - 1), (NEXT, t + 1)):
        if 0 <= other < images.shape[0]:
            frame, neighbour = (images[each, :].astype(np.float32) for each in (t, other))
            yield colour_error(frame, neighbour, flows[t, direction] - residual_flows[t, direction])
