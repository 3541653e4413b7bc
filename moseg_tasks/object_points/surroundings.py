"""Surroundings of an object: the tracks that are not its own, and where their motion would bring its points."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from moseg.tasks.object_points.motion import NOWHERE, Found, FramePair, track_near
from moseg.tasks.object_points.patches import correlate_patches

_NUM_NEIGHBOURS = 6
_WINDOW = 11
"""Side of the Lucas-Kanade window beside an object, px: a larger one reaches over its outline."""
_SLIP = 4.0
"""Largest distance of what Lucas-Kanade finds from where the neighbours' motion leads, px."""


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
            return Found(points, nothing, np.full(len(points), NOWHERE)), nothing
        near = cKDTree(self.points).query(points, k=_NUM_NEIGHBOURS)[1]
        expected = points + np.median(self.motion[near], axis=1).astype(np.float32)
        images, side = (pair.image0, pair.image1), pair.params.patch
        found, is_near = track_near(*images, points, expected, _WINDOW, 0, pair.params)
        is_near &= np.linalg.norm(found - expected, axis=1) <= _SLIP
        place = np.where(is_near[:, None], found, expected)
        ways = (correlate_patches(pair.image0, points, pair.image1, end, side) for end in (expected, place))
        return Found(place, is_near, np.maximum(*ways)), self.is_background[near].all(axis=1)
