"""Regions that the points of an object span: what lies between them, and little around them."""

import cv2
import numpy as np


def region_between(
    points: np.ndarray, shape: tuple[int, int], closing: float, margin: float, edge: float
) -> np.ndarray:
    """Return the pixels between an object's points, and about `margin` px around these.

    A plain road beside a car has no points of its own, so that the nearest ones are the car's; but it has them on one
    side only.

    Parameters
    ----------
    points : float (N, 2)
        xy, px.
    shape : (height, width)
        px.
    closing : float
        Radius, px: a pixel lies between the points if every disc of it that contains the pixel contains a point too.
    margin : float
        px; at most `closing` counts. It is added before the closing is complete, so that gaps between points that are
        little wider than the disc are bridged.
    edge : float
        Points within this distance of the frame's edge, px, count on the edge too: what the frame cuts off goes on.

    Returns
    -------
    bool (y, x)

    References
    ----------
    Serra, "Image Analysis and Mathematical Morphology", 1982: closing by a disc, here of the points, by distances.
    """
    corner = np.array(shape[::-1]) - 1
    marked = [points]
    for axis in (0, 1):
        for side in (0, corner[axis]):
            cut_off = points[np.abs(points[:, axis] - side) <= edge].copy()
            cut_off[:, axis] = side
            marked.append(cut_off)
    cells = np.clip(np.rint(np.concatenate(marked)).astype(int), 0, corner)
    # The frame, or what of it the points can reach, with what lies beyond its edges.
    pad = int(np.ceil(closing)) + 1
    first, last = (np.maximum(cells.min(axis=0) - pad, 0), np.minimum(cells.max(axis=0) + pad, corner))
    free = np.ones(last[::-1] - first[::-1] + 1 + 2 * pad, np.uint8)
    x, y = (cells - first + pad).T
    free[y, x] = 0
    near = (_distance(free) <= closing).astype(np.uint8)
    inside = _distance(near) > closing - min(margin, closing)
    region = np.zeros(shape, bool)
    region[first[1] : last[1] + 1, first[0] : last[0] + 1] = inside[pad:-pad, pad:-pad]
    return region


def _distance(mask: np.ndarray) -> np.ndarray:
    """Return the distance of each pixel from the nearest one that is 0, float32 (y, x)."""
    return cv2.distanceTransform(mask, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
