"""Motions of one object between two frames: similarities, refined by tracking in the frame that they bring along."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.parameters import ObjectPointParams
from moseg.tasks.object_points.patches import correlate_patches
from moseg.tasks.object_points.similarities import expect_next, fit_similarities, fit_similarity, move

_STOP = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 30, 0.01)
"""OpenCV's default: 30 iterations or a step below 0.01 px."""
_NUM_ROUNDS = 2
_MAX_POINTS = 150
"""Points that refine a motion; an even choice of more."""
_SAME = 1.0
"""Two motions are one if they bring the object's points to places that are less far apart on average, px."""
NOWHERE = np.float32(-1)
"""Correlation of a point outside the frame."""


class Found(NamedTuple):
    """Points in the next frame.

    Attributes
    ----------
    points : float32 (N, 2)
        xy, px: as tracked, or where the motion brings them.
    is_tracked : bool (N,)
    correlation : float32 (N,)
        Of the patches in both frames; -1 outside the frame.
    """

    points: np.ndarray
    is_tracked: np.ndarray
    correlation: np.ndarray


class FramePair(NamedTuple):
    """Two frames, uint8 (y, x), and the parameters."""

    image0: np.ndarray
    image1: np.ndarray
    params: ObjectPointParams

    def motions(
        self, shown0: np.ndarray, shown1: np.ndarray, points: np.ndarray, before: list[np.ndarray]
    ) -> list[np.ndarray]:
        """Return the object's motions to the second frame.

        Parameters
        ----------
        shown0, shown1 : float32 (M, 2)
            Tracks of the object that both frames show, xy, px.
        points : float32 (N, 2)
            All points of the object in the first frame.
        before : list of float64 (2, 3)
            Its motions from the frame before.

        Returns
        -------
        list of float64 (2, 3)
            Similarities.
        """
        params = self.params
        centre = (np.array(self.image0.shape[::-1]) - 1) / 2
        starts = fit_similarities(shown0, shown1, params.tolerance, params.min_points, params.max_motions)
        starts += [expect_next(similarity, centre, params.max_growth) for similarity in before]
        chosen = points[:: -(-len(points) // _MAX_POINTS)] if len(points) else points
        found: list[np.ndarray] = []
        for start in starts:
            refined = self._refine(start, chosen)
            if refined is None:
                continue
            place = move(refined, chosen)
            if all(np.linalg.norm(place - move(other, chosen), axis=1).mean() >= _SAME for other in found):
                found.append(refined)
        return found[: params.max_motions]

    def find(self, motions: list[np.ndarray], points: np.ndarray) -> Found:
        """Return each point where the motion brings it under which its patches correlate best."""
        found = [self._track(motion, points) for motion in motions]
        best = np.argmax([each.correlation for each in found], axis=0), np.arange(len(points))
        return Found(*(np.array(each)[best] for each in zip(*found, strict=True)))

    def _refine(self, similarity: np.ndarray, points: np.ndarray) -> np.ndarray | None:
        """Return the similarity that most points show which are tracked from where one brings them; None if few do."""
        params = self.params
        for _ in range(_NUM_ROUNDS):
            found = self._track(similarity, points)
            near = found.is_tracked
            fitted = fit_similarity(points[near], found.points[near], params.tolerance, params.min_points)
            if fitted is None:
                return None
            similarity, agrees = fitted
        num_inside = np.count_nonzero(found.correlation > NOWHERE)
        return similarity if np.count_nonzero(agrees) >= params.min_share * num_inside else None

    def _track(self, similarity: np.ndarray, points: np.ndarray) -> Found:
        """Return points as tracked from the first frame, brought along by a similarity, to the second."""
        params = self.params
        expected = move(similarity, points)
        height, width = self.image1.shape
        window = self._window(expected)
        if window is None:
            return Found(expected, np.zeros(len(points), bool), np.full(len(points), NOWHERE))
        rows, columns = window
        origin = np.float32([columns.start, rows.start])
        shifted = similarity - np.c_[np.zeros((2, 2)), origin]
        size = columns.stop - columns.start, rows.stop - rows.start
        brought = cv2.warpAffine(self.image0, shifted, size, flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
        image1 = np.ascontiguousarray(self.image1[window])
        start = expected - origin
        found, is_near = track_near(brought, image1, start, start, params.window, params.pyramid_levels, params)
        is_near &= np.linalg.norm(found - start, axis=1) <= params.slip
        place = np.where(is_near[:, None], found, start)
        correlation = correlate_patches(brought, start, image1, place, params.patch)
        place += origin
        is_inside = ((place >= 0) & (place <= [width - 1, height - 1])).all(axis=1)
        return Found(place, is_near & is_inside, np.where(is_inside, correlation, NOWHERE))

    def _window(self, points: np.ndarray) -> tuple[slice, slice] | None:
        """Return rows and columns of the second frame around those of the points that are in it; None without any."""
        height, width = self.image1.shape
        inside = points[((points >= 0) & (points <= [width - 1, height - 1])).all(axis=1)]
        if not len(inside):
            return None
        margin = self.params.window << self.params.pyramid_levels
        left, top = np.maximum(np.floor(inside.min(axis=0)).astype(int) - margin, 0)
        right, bottom = np.minimum(np.ceil(inside.max(axis=0)).astype(int) + margin + 1, [width, height])
        return slice(top, bottom), slice(left, right)


def track_near(
    image0: np.ndarray,
    image1: np.ndarray,
    points: np.ndarray,
    start: np.ndarray,
    window: int,
    levels: int,
    params: ObjectPointParams,
) -> tuple[np.ndarray, np.ndarray]:
    """Track points from expected places, and return where they are found and whether they lead back.

    Parameters
    ----------
    image0, image1 : uint8 (y, x)
    points, start : float32 (N, 2)
        xy in the first image, and expected in the second, px.
    window, levels : side, px, and levels of the pyramid.
    params : ObjectPointParams
        `forward_backward` is read.

    Returns
    -------
    points : float32 (N, 2)
    is_near : bool (N,)
    """
    if not len(points):
        return np.zeros((0, 2), np.float32), np.zeros(0, bool)
    search = {
        "winSize": (window, window),
        "maxLevel": levels,
        "criteria": _STOP,
        "flags": cv2.OPTFLOW_USE_INITIAL_FLOW,
    }
    found, is_found, _ = cv2.calcOpticalFlowPyrLK(image0, image1, points, start.copy(), **search)
    back, is_back, _ = cv2.calcOpticalFlowPyrLK(image1, image0, found, points.copy(), **search)
    is_near = np.linalg.norm(back - points, axis=1) <= params.forward_backward
    return found, is_near & (is_found.ravel() > 0) & (is_back.ravel() > 0)
