"""What lies around an object: motions of the nearest other tracks, and new corners that belong to either."""

from typing import NamedTuple

import cv2
import numpy as np
from scipy.spatial import cKDTree

from moseg.tasks.object_points.motion import Found, FramePair, track_near
from moseg.tasks.object_points.patches import correlate_patches

_NUM_NEIGHBOURS = 6
_WINDOW = 11
"""Side of the Lucas-Kanade window beside an object, px: a larger one reaches over its outline."""
_SLIP = 4.0
"""Largest distance of what Lucas-Kanade finds from where the neighbours' motion leads, px."""
_MAX_CORNERS = 500
"""New corners of an object in a frame."""
_MAX_POINTS = 5000
"""Points of an object in a frame up to which there are new ones."""
_CORNER_BLOCK = 5


class Surroundings(NamedTuple):
    """Tracks that are not the object's and are seen in both frames of a pair.

    Attributes
    ----------
    points : float32 (N, 2)
        xy in the first frame, px.
    motion : float32 (N, 2)
        To the second frame, px.
    is_background : bool (N,)
        Else the track belongs to another moving object.
    """

    points: np.ndarray
    motion: np.ndarray
    is_background: np.ndarray

    def find(self, pair: FramePair, points: np.ndarray) -> tuple[Found, np.ndarray]:
        """Return points (N, 2) as the median motion of their nearest tracks moves them.

        Returns
        -------
        Found
            The better of where that motion leads and of what is tracked from there.
        is_background : bool (N,)
            Whether all these tracks are the background's.
        """
        if len(self.points) < _NUM_NEIGHBOURS or not len(points):
            nothing = np.zeros(len(points), bool)
            return Found(points, nothing, np.full(len(points), np.float32(-1))), nothing
        near = cKDTree(self.points).query(points, k=_NUM_NEIGHBOURS)[1]
        expected = points + np.median(self.motion[near], axis=1).astype(np.float32)
        images, side = (pair.image0, pair.image1), pair.params.patch
        found, is_near = track_near(*images, points, expected, _WINDOW, 0, pair.params)
        is_near &= np.linalg.norm(found - expected, axis=1) <= _SLIP
        place = np.where(is_near[:, None], found, expected)
        ways = (correlate_patches(pair.image0, points, pair.image1, end, side) for end in (expected, place))
        return Found(place, is_near, np.maximum(*ways)), self.is_background[near].all(axis=1)


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
