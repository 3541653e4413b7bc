"""New corners of a frame around an object's points, on both sides of its outline."""

import cv2
import numpy as np

from moseg.tasks.object_points.motion import FramePair

_MAX_CORNERS = 500
"""New corners of an object in a frame."""
_MAX_POINTS = 5000
"""Points of an object in a frame up to which there are new ones."""
_CORNER_BLOCK = 5


def new_corners(image: np.ndarray, own: np.ndarray, others: np.ndarray, pair: FramePair) -> np.ndarray:
    """Return corners of a frame around an object's points and away from all points.

    Parameters
    ----------
    image : uint8 (y, x)
        The first frame of the pair, equalised.
    own, others : float32 (N, 2), (M, 2)
        xy of the object's points and of all others, px.
    pair : FramePair
        Its parameters are read.

    Returns
    -------
    float32 (K, 2)
        Strongest first.
    """
    params, room = pair.params, min(_MAX_CORNERS, _MAX_POINTS - len(own))
    if room <= 0:
        return np.zeros((0, 2), np.float32)
    first = np.maximum(np.floor(own.min(axis=0) - params.reach).astype(int), 0)
    last = np.ceil(own.max(axis=0) + params.reach).astype(int)
    part = np.ascontiguousarray(image[first[1] : last[1] + 1, first[0] : last[0] + 1])
    seen = np.concatenate([own, others])
    far = _distance_to(seen - first, part.shape) > params.spacing
    free = far & (_distance_to(own - first, part.shape) <= params.reach)
    corners = cv2.goodFeaturesToTrack(
        part,
        room,
        params.corner_quality,
        params.spacing,
        mask=free.astype(np.uint8),
        blockSize=_CORNER_BLOCK,
    )
    if corners is None:
        return np.zeros((0, 2), np.float32)
    return corners.reshape(-1, 2) + first.astype(np.float32)


def _distance_to(points: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Return the distance of each pixel from the nearest of the points inside, px, float32 (y, x)."""
    free = np.ones(shape, np.uint8)
    x, y = np.rint(points).astype(int).T
    inside = (x >= 0) & (y >= 0) & (x < shape[1]) & (y < shape[0])
    free[y[inside], x[inside]] = 0
    return cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
