"""Regions of graphics: what belongs to edges that stand still, and its outline in convex polygons."""

from collections.abc import Iterator

import cv2
import numpy as np

from moseg.schemas.parameters import ScreenGraphicsParams

_MAX_HULL = 2.0
"""Area of a region's convex hull, in areas of the region; a region that is less solid is divided."""


def with_plain_ground(region: np.ndarray, frames: np.ndarray, params: ScreenGraphicsParams, join: int) -> np.ndarray:
    """Add to a region the ground around its edges whose colours change less than those of the scene around it.

    Of a sign that lets some of the scene shine through, the border is no edge that is the same in all frames. Ground
    that goes on beyond the reach is that of a scene of one colour.

    Parameters
    ----------
    region : bool (y, x)
        Not empty.
    frames : uint8 (frame, y, x, 3)
    params : ScreenGraphicsParams
    join : int
        Distance to which edges belong together, px.

    Returns
    -------
    bool (y, x)
    """
    x, y, width, height = cv2.boundingRect(region.astype(np.uint8))
    reach = join + round(params.reach * min(width, height))
    near, around = (_expanded((x, y, width, height), times * reach, region.shape) for times in (1, 2))
    is_scene = np.ones(region.shape, bool)
    is_scene[near] = False
    beyond, seen = is_scene[around], region[around]
    if not beyond.any():
        return region
    usual, deviation = _over_time(frames[:, around[0], around[1]])
    steady = deviation <= params.steadiness * float(np.median(deviation[beyond]))
    plain = (
        cv2.magnitude(*(cv2.Sobel(usual, cv2.CV_32F, *order) / 8 for order in ((1, 0), (0, 1)))) < params.min_gradient
    )
    square = np.ones((3, 3), np.uint8)
    _, labels = cv2.connectedComponents(cv2.morphologyEx((steady & plain).astype(np.uint8), cv2.MORPH_OPEN, square))
    is_ground = np.isin(labels, labels[seen]) & ~np.isin(labels, labels[beyond]) & (labels > 0)
    grown = region.copy()
    # Its border is not plain.
    grown[around] |= cv2.dilate(is_ground.astype(np.uint8), square, iterations=3).astype(bool)
    return grown


def convex_parts(mask: np.ndarray, smallest: int) -> Iterator[np.ndarray]:
    """Yield convex polygons int (corner, 2), xy, that cover a mask, and together little more than it.

    Parameters
    ----------
    mask : bool (y, x)
    smallest : int
        Side of a part that is not divided further, px.
    """
    _, labels = cv2.connectedComponents(mask.astype(np.uint8))
    for label in range(1, labels.max() + 1):
        yield from _divided(np.argwhere(labels == label)[:, ::-1], smallest)


def _divided(points: np.ndarray, smallest: int) -> Iterator[np.ndarray]:
    """Yield the hull of points int (point, 2), or those of their halves where it is mostly empty."""
    hull = cv2.convexHull(points.astype(np.int32))[:, 0]
    low, sides = points.min(axis=0), np.ptp(points, axis=0)
    axis = int(sides.argmax())
    if sides[axis] <= smallest or cv2.contourArea(hull) <= _MAX_HULL * len(points):
        yield hull
        return
    is_first = points[:, axis] <= low[axis] + sides[axis] // 2
    yield from _divided(points[is_first], smallest)
    yield from _divided(points[~is_first], smallest)


def _over_time(frames: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the median grey level, and the median deviation of the colour that changes most, float32 (y, x)."""
    usual = np.median(frames, axis=0).astype(np.int16)
    deviation = np.median(np.abs(frames.astype(np.int16) - usual), axis=0).max(axis=-1)
    return cv2.cvtColor(usual.astype(np.uint8), cv2.COLOR_RGB2GRAY).astype(np.float32), deviation.astype(np.float32)


def _expanded(box: tuple[int, int, int, int], by: int, shape: tuple[int, int]) -> tuple[slice, slice]:
    """Return the rows and columns of a box (x, y, width, height) with a margin, inside an image of `shape`."""
    x, y, width, height = box
    rows = slice(max(y - by, 0), min(y + height + by, shape[0]))
    return rows, slice(max(x - by, 0), min(x + width + by, shape[1]))
