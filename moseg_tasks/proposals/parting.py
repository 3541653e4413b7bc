"""Parting of components into objects that are far from each other, after they were seen as one or before."""

from collections.abc import Iterator

import cv2
import numpy as np
from scipy import ndimage
from scipy.sparse.csgraph import connected_components

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.saliency.consistency import NEXT, PREVIOUS

_AGREEMENT = 0.9
"""Share of the pixels of a connected piece from which on all of it is of one part."""


def part_distant(labels: np.ndarray, flows: np.ndarray, params: IdentityParams, gap: int = 1) -> np.ndarray:
    """Part components whose pieces stay far from each other.

    Vehicles that follow each other, far away, or a dog beside its owner are one component of space and time if they are
    one piece in some frame. Pieces are different objects if they are farther apart than the larger of them is wide, for
    some frames on end: what a pole hides in part has no such gaps, and limbs do not get that far. From there each pixel
    takes the label to which flow leads it, so that what is one piece is parted as well.

    Parameters
    ----------
    labels : uint16 or int32 (T, h, w)
        Component of each pixel of the working grid; 0 = background.
    flows : float32 (T, 2, h, w, 2)
        Flow to the previous and to the next frame, px/frame; zeros where there is no such frame.
    params : IdentityParams
    gap : int, optional
        Pictures from a frame to those with which it was compared: pieces are apart for as many times more frames.

    Returns
    -------
    labels : as `labels`
        The largest part keeps its label; others get new labels above all existing ones.

    Raises
    ------
    InputError
        The flows are not those of the labels.
    """
    expected = (len(labels), 2, *labels.shape[1:], 2)
    if flows.shape != expected:
        raise InputError("flows are not those of the labels", got=flows.shape, expected=expected)
    result = labels.copy()
    newest = int(labels.max(initial=0))
    for label, box in enumerate(ndimage.find_objects(labels.astype(np.int32)), start=1):
        waiting, parts = [label] * (box is not None), 1
        while waiting and parts < params.split_parts:
            current = waiting.pop()
            part = _parts(result[box] == current, flows, box, labels[0].size, params, gap)
            sizes = np.bincount(part.ravel())[1:]
            if len(sizes) < 2:
                continue
            waiting.append(current)
            for number in np.argsort(-sizes, kind="stable")[1 : 1 + params.split_parts - parts] + 1:
                newest, parts = newest + 1, parts + 1
                result[box][part == number] = newest
                waiting.append(newest)
    return result


def _parts(component: np.ndarray, flows, box, num_pixels: int, params: IdentityParams, gap: int) -> np.ndarray:
    """Return the part, from 1, of each pixel of a component bool (T, h, w); all zeros where it is one object."""
    pieces = [_distant_pieces(mask, params.min_area * num_pixels, params.part_distance) for mask in component]
    counts = np.array([piece.max(initial=0) for piece in pieces])
    start = _clearest(counts, min(gap * params.part_frames, len(component)))
    part = np.zeros(component.shape, np.int32)
    if start is None:
        return part
    part[start] = pieces[start]
    for frames, back in ((range(start + 1, len(component)), PREVIOUS), (range(start - 1, -1, -1), NEXT)):
        last = start
        for t in frames:
            if component[t].any():
                flow = flows[box[0].start + t, back, box[1], box[2]]
                part[t] = _carried(component[t], part[last], flow)
                last = t
    return part


def _clearest(counts: np.ndarray, num_frames: int) -> int | None:
    """Return the frame of most pieces, within a run of `num_frames` or more with several; None without such a run."""
    runs = (run for run in _runs(counts > 1) if len(run) >= num_frames)
    frames = np.concatenate([np.zeros(0, int), *runs])
    return int(frames[np.argmax(counts[frames])]) if len(frames) else None


def _runs(holds: np.ndarray) -> Iterator[np.ndarray]:
    """Yield the frames of each run in which something holds."""
    numbered, _ = ndimage.label(holds)
    yield from (np.arange(run.start, run.stop) for (run,) in ndimage.find_objects(numbered))


def _distant_pieces(mask: np.ndarray, min_area: float, distance: float) -> np.ndarray:
    """Return the pieces of a mask (h, w) that are farther apart than `distance` widths, from 1: int (h, w).

    Smaller pieces than `min_area` belong to the nearest one. It is all zeros if none is as large.
    """
    _, pieces, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    areas = stats[1:, cv2.CC_STAT_AREA]
    large = np.flatnonzero(areas >= min_area) + 1
    if len(large) == 0:
        return np.zeros(mask.shape, np.int32)
    if len(large) == 1:
        return mask.astype(np.int32)
    apart = np.stack([cv2.distanceTransform((pieces != piece).astype(np.uint8), cv2.DIST_L2, 5) for piece in large])
    between = np.array([[away[pieces == piece].min() for piece in large] for away in apart])
    widths = np.sqrt(areas[large - 1])
    near = between <= distance * np.maximum.outer(widths, widths)
    _, group = connected_components(near, directed=False)
    return np.where(mask, group[apart.argmin(axis=0)] + 1, 0).astype(np.int32)


def _carried(mask: np.ndarray, part: np.ndarray, flow: np.ndarray) -> np.ndarray:
    """Return the part of each pixel of a mask (h, w), from where `flow` (h, w, 2) leads it in the frame of `part`.

    What is outside of all parts there has the nearest one. Connected pieces whose pixels nearly agree have one part.
    """
    height, width = mask.shape
    y, x = np.nonzero(mask)
    there = np.rint(np.stack([y, x]) + flow[y, x, ::-1].T).astype(np.int64)
    there = np.clip(there, 0, [[height - 1], [width - 1]])
    nearest = ndimage.distance_transform_edt(part == 0, return_distances=False, return_indices=True)
    found = np.zeros(mask.shape, np.int32)
    found[y, x] = part[tuple(nearest[:, there[0], there[1]])]
    num_pieces, pieces = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    votes = np.zeros((num_pieces, part.max() + 1), np.int64)
    np.add.at(votes, (pieces[y, x], found[y, x]), 1)
    agrees = votes.max(axis=1) >= _AGREEMENT * votes.sum(axis=1)
    return np.where(mask & agrees[pieces], votes.argmax(axis=1)[pieces], found).astype(np.int32)
