"""Parting of components into objects that are far from each other, after they were seen as one or before."""

from collections.abc import Iterator

import cv2
import numpy as np
from scipy import ndimage
from scipy.sparse.csgraph import connected_components

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.identity import IdentityParams
from moseg.tasks.saliency.consistency import NEXT, PREVIOUS

_MAX_PIECES = 16
"""Pieces of a component in a frame that may be objects, the largest ones."""


def part_distant(labels: np.ndarray, flows: np.ndarray, params: IdentityParams, gap: int = 1) -> np.ndarray:
    """Part components whose pieces stay far from each other.

    Vehicles that follow each other, far away, or a dog beside its owner are one component of space and time if they are
    one piece in some frame. Pieces are different objects if they are farther apart than the larger of them is wide, for
    some frames on end: limbs do not get that far. From there each pixel takes the label to which flow leads it, so that
    what is one piece is parted as well.

    Parameters
    ----------
    labels : integer (T, h, w)
        Connected component of each pixel of the working grid; 0 = background.
    flows : float32 (T, 2, h, w, 2)
        Flow to the previous and to the next frame, px/frame; zeros where there is no such frame.
    params : IdentityParams
    gap : int, optional
        Pictures from a frame to those with which it was compared: pieces are apart for as many times more frames.

    Returns
    -------
    labels : int32 (T, h, w)
        The largest part keeps its label; others get new labels above all existing ones.

    Raises
    ------
    InputError
        The flows are not those of the labels.
    """
    expected = (len(labels), 2, *labels.shape[1:], 2)
    if flows.shape != expected:
        raise InputError("flows are not those of the labels", got=flows.shape, expected=expected)
    result = labels.astype(np.int32)
    num_frames = min(gap * params.part_frames, len(labels))
    newest = int(result.max(initial=0))
    for label, box in enumerate(ndimage.find_objects(result), start=1):
        waiting, parts = [label] * (box is not None), 1
        while waiting and parts < params.split_parts:
            current = waiting.pop()
            part = _parts(result[box] == current, flows, box, labels[0].size, num_frames, params)
            count = min(int(part.max(initial=0)), 1 + params.split_parts - parts)
            if count < 2:
                continue
            parts += count - 1
            waiting.append(current)
            for number in range(2, count + 1):
                newest += 1
                result[box][part == number] = newest
                waiting.append(newest)
    return result


def _parts(
    component: np.ndarray, flows, box: tuple[slice, ...], num_pixels: int, num_frames: int, params: IdentityParams
) -> np.ndarray:
    """Return the part, 1 being the largest, of each pixel of a component bool (T, h, w); all zeros where it is one."""
    min_area = params.min_area * num_pixels
    part = np.zeros(component.shape, np.int32)
    pieces = [_distant_pieces(mask, min_area, params.part_distance) for mask in component]
    start = _clearest(np.array([piece.max(initial=0) for piece in pieces]), num_frames)
    if start is None:
        return part
    part[start] = pieces[start]
    for frames, back in ((range(start + 1, len(component)), PREVIOUS), (range(start - 1, -1, -1), NEXT)):
        last = start
        for t in frames:
            if component[t].any():
                motion = abs(t - last) * flows[box[0].start + t, back, box[1], box[2]]
                part[t] = _carried(component[t], part[last], motion, min_area)
                last = t
    return _lasting_parts(part, component, min_area, num_frames)


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
    """Return the pieces of a mask (h, w) that are farther apart than `distance` widths, from 1: int32 (h, w).

    Smaller pieces than `min_area` belong to the nearest one. It is all zeros if none is as large.
    """
    _, pieces, stats, _ = cv2.connectedComponentsWithStats(mask.astype(np.uint8), connectivity=8)
    areas = stats[1:, cv2.CC_STAT_AREA]
    order = np.argsort(-areas, kind="stable")[:_MAX_PIECES]
    large = order[areas[order] >= min_area] + 1
    if len(large) < 2:
        return mask.astype(np.int32) * len(large)
    apart = np.stack([cv2.distanceTransform((pieces != piece).astype(np.uint8), cv2.DIST_L2, 5) for piece in large])
    between = np.array([ndimage.minimum(away, pieces, large) for away in apart])
    widths = np.sqrt(areas[large - 1])
    near = between <= distance * np.maximum.outer(widths, widths)
    _, group = connected_components(near, directed=False)
    return np.where(mask, group[apart.argmin(axis=0)] + 1, 0).astype(np.int32)


def _carried(mask: np.ndarray, part: np.ndarray, motion: np.ndarray, min_area: float) -> np.ndarray:
    """Return the part of each pixel of a mask (h, w), from where `motion` (h, w, 2), px, leads it in `part`.

    Beside all parts it is the nearest one; in a connected piece, parts of less than `min_area` belong to the largest. A
    piece that is led to none of them has no part, 0.
    """
    found = np.zeros(mask.shape, np.int32)
    if not part.any():
        return found
    y, x = np.nonzero(mask)
    limits = np.array(mask.shape)[:, None] - 1
    there = np.clip(np.rint(np.stack([y, x]) + motion[y, x, ::-1].T), 0, limits).astype(np.int64)
    away, nearest = ndimage.distance_transform_edt(part == 0, return_indices=True)
    found[y, x] = part[tuple(nearest[:, there[0], there[1]])]
    num_pieces, pieces = cv2.connectedComponents(mask.astype(np.uint8), connectivity=8)
    votes = np.zeros((num_pieces, part.max() + 1), np.int64)
    np.add.at(votes, (pieces[y, x], found[y, x]), 1)
    # An object moves less than its width farther than flow leads it.
    apart = np.full(num_pieces, np.inf)
    np.minimum.at(apart, pieces[y, x], away[there[0], there[1]])
    main = np.where(apart <= np.sqrt(votes.sum(axis=1)), votes.argmax(axis=1), 0)
    is_small = votes[pieces, found] < min_area
    return np.where(mask, np.where(is_small | (main[pieces] == 0), main[pieces], found), 0).astype(np.int32)


def _lasting_parts(part: np.ndarray, component: np.ndarray, min_area: float, num_frames: int) -> np.ndarray:
    """Return the parts that are large enough in enough frames, by falling size from 1; what has none belongs to 1."""
    areas = np.stack([np.bincount(frame.ravel(), minlength=part.max() + 1) for frame in part])
    areas[:, 0] = 0
    sizes = np.where((areas >= min_area).sum(axis=0) >= num_frames, areas.sum(axis=0), 0)
    order = np.argsort(-sizes, kind="stable")[: np.count_nonzero(sizes)]
    if len(order) < 2:
        return np.zeros_like(part)
    number = np.ones(len(sizes), np.int32)
    number[order] = np.arange(1, len(order) + 1)
    return np.where(component, number[part], 0).astype(np.int32)
