"""Prompts that moving regions give to a segmentation network, and the choice among the masks that it returns."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.motion_prompts import MotionPromptParams


class MotionPrompts(NamedTuple):
    """Prompts of the regions of one frame.

    Attributes
    ----------
    labels : uint16 (y, x)
        Regions 1 to n, 0 = background.
    boxes : float32 (n, 4)
        Left, top, right, bottom, px.
    points : float32 (n, k, 2)
        xy, px; all of them lie in the region.
    source : intp (n,)
        Label of each region in the labels that were given.
    """

    labels: np.ndarray
    boxes: np.ndarray
    points: np.ndarray
    source: np.ndarray


def prompts_of_regions(labels: np.ndarray, is_moving: np.ndarray, params: MotionPromptParams) -> MotionPrompts:
    """Return the prompts of the moving regions of a frame that are large enough.

    A box holds all pixels of the region but the outermost ones on each side, and a margin. Points lie far from the
    border of the region, which is its least certain part, and from each other.

    Parameters
    ----------
    labels : integer (y, x)
        Regions 1 to m, 0 = background.
    is_moving : bool (m,)
        Whether each region moves; others prompt nothing.
    params : MotionPromptParams

    Raises
    ------
    InputError
        There are labels beyond those of `is_moving`.
    """
    if labels.max(initial=0) > len(is_moving):
        raise InputError("a region without evidence", got=int(labels.max()), expected=f"labels up to {len(is_moving)}")
    areas = np.bincount(labels.ravel(), minlength=len(is_moving) + 1)[1:]
    source = 1 + np.flatnonzero(np.asarray(is_moving, bool) & (areas >= max(1, params.min_area * labels.size)))
    renumbered = np.zeros(len(is_moving) + 1, np.uint16)
    renumbered[source] = np.arange(1, len(source) + 1)
    regions = [labels == label for label in source]
    boxes = np.array([_box(region, params) for region in regions], np.float32).reshape(-1, 4)
    points = np.array([_points(region, params.num_points) for region in regions], np.float32)
    return MotionPrompts(renumbered[labels], boxes, points.reshape(-1, params.num_points, 2), source)


def _box(region: np.ndarray, params: MotionPromptParams) -> tuple[float, float, float, float]:
    """Return left, top, right and bottom of a region without its strays, widened by the margin, px."""
    sides = []
    for axis in (0, 1):
        # The cumulative share of pixels by column, then by row.
        share = np.cumsum(np.count_nonzero(region, axis=axis)) / np.count_nonzero(region)
        first = int(np.searchsorted(share, params.trimmed, side="right"))
        last = int(np.searchsorted(share, 1 - params.trimmed))
        margin = params.margin * (last + 1 - first)
        sides.append((max(first - margin, 0.0), min(last + 1 + margin, float(len(share)))))
    (left, right), (top, bottom) = sides
    return left, top, right, bottom


def _points(region: np.ndarray, num_points: int) -> list[tuple[int, int]]:
    """Return points xy of a region; the same one again where the region has no other."""
    # The frame's own border counts as a border: an object that leaves the frame is cut there.
    padded = np.pad(region.astype(np.uint8), 1)
    room = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    rows, columns = np.indices(region.shape, np.float32)
    points: list[tuple[int, int]] = []
    for _ in range(num_points):
        row, column = np.unravel_index(int(np.argmax(room)), room.shape)
        if not room[row, column]:
            row, column = points[0][1], points[0][0]
        points.append((int(column), int(row)))
        room = np.minimum(room, np.hypot(rows - row, columns - column))
    return points


def choose_masks(
    masks: np.ndarray, quality: np.ndarray, prompts: MotionPrompts, params: MotionPromptParams
) -> tuple[np.ndarray, np.ndarray]:
    """Choose one of the masks of each region: the best by the network's estimate among those that fit the region.

    A mask fits if it covers enough of the region and is not many times as large. A region for which no mask fits is
    dropped: the network does not see there what moves. The IoU with the region would be the wrong measure, because a
    moving region often shows only a part of its object.

    Parameters
    ----------
    masks : bool (n, c, y, x)
    quality : float64 (n, c)
        The network's estimates.
    prompts : MotionPrompts
    params : MotionPromptParams

    Returns
    -------
    region : intp (m,)
        Index of the prompts that have a mask, ascending.
    chosen : intp (m,)
        Its index among the c masks.
    """
    regions = prompts.labels == np.arange(1, len(masks) + 1)[:, None, None]
    areas = np.count_nonzero(regions, axis=(1, 2))[:, None]
    covered = np.count_nonzero(masks & regions[:, None], axis=(2, 3))
    fits = covered >= np.maximum(params.min_coverage * areas, 1)
    fits &= np.count_nonzero(masks, axis=(2, 3)) <= params.max_growth * areas
    region = np.flatnonzero(fits.any(axis=1))
    return region, np.argmax(np.where(fits, quality, -np.inf)[region], axis=1)
