"""Points of moving objects through a window of frames: lost tracks and new corners, by the object's own motion."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import cv2
import numpy as np
from scipy.spatial import cKDTree

from moseg.schemas.parameters import ObjectPointParams
from moseg.tasks.object_points.corners import new_corners
from moseg.tasks.object_points.motion import FramePair
from moseg.tasks.object_points.patches import contrast
from moseg.tasks.object_points.surroundings import Surroundings
from moseg.tasks.roundness import roundness


class ObjectPoints(NamedTuple):
    """Points beside the tracks of a window of F frames.

    Attributes
    ----------
    points : float32 (N, F, 2)
        xy, px; 0 where not visible.
    visible : bool (N, F)
        One run of consecutive frames per point.
    object : uint16 (N,)
        0 = background.
    """

    points: np.ndarray
    visible: np.ndarray
    object: np.ndarray


def follow_objects(
    read_frame: Callable[[int], np.ndarray],
    points: np.ndarray,
    visible: np.ndarray,
    objects: np.ndarray,
    params: ObjectPointParams,
) -> ObjectPoints:
    """Follow moving objects where their tracks end, forward and backward in time.

    What comes near grows by a tenth to a half from one frame to the next, and a tracker of points loses it. But all
    its points move alike: up to `max_motions` similarities of the tracks that both frames show, and those that are
    expected from the frame before, bring the first frame along, in which nothing grows any more. There lost points are
    tracked on, as long as their patches correlate, and better than under the motion of what is around them. New corners
    around an object's points join the object or the background, whichever motion explains them clearly better, so that
    the outline has points on both sides.

    Parameters
    ----------
    read_frame : callable
        Returns the frame of a number from 0 to F - 1, uint8 (y, x, 3), RGB.
    points : float32 (N, F, 2)
        Tracks, xy, px; read only where `visible`.
    visible : bool (N, F)
    objects : integer (N,)
        Moving object of each track; 0 = none.
    params : ObjectPointParams

    Returns
    -------
    ObjectPoints
    """
    num_frames = visible.shape[1]
    found = _Followed(num_frames, points.dtype)
    if params.max_motions and objects.any():
        for order in (range(num_frames), range(num_frames - 1, -1, -1)):
            _follow(read_frame, order, points, visible, objects, params, found)
    return found.collect(params.min_frames)


class _Followed:
    """Points that were followed, from frame to frame."""

    def __init__(self, num_frames: int, dtype):
        self._num_frames, self._dtype = num_frames, dtype
        self._num_points = 0
        self._seen: list[tuple[int, np.ndarray, np.ndarray]] = []
        self._objects: list[np.ndarray] = []
        self._is_new: list[np.ndarray] = []

    def add(self, number: int, label: int, is_new: bool = False) -> np.ndarray:
        """Return the numbers of so many points of an object; new ones are corners, others continue a track."""
        self._objects.append(np.full(number, label, np.uint16))
        self._is_new.append(np.full(number, is_new))
        self._num_points += number
        return np.arange(self._num_points - number, self._num_points)

    def see(self, frame: int, numbers: np.ndarray, points: np.ndarray) -> None:
        """Note the places of points, xy, in a frame."""
        self._seen.append((frame, numbers, points))

    def collect(self, min_frames: int) -> ObjectPoints:
        """Return the points, without corners of objects that were followed through less than `min_frames` frames."""
        points = np.zeros((self._num_points, self._num_frames, 2), self._dtype)
        visible = np.zeros(points.shape[:2], bool)
        for frame, numbers, places in self._seen:
            points[numbers, frame], visible[numbers, frame] = places, True
        objects = np.concatenate([np.zeros(0, np.uint16), *self._objects])
        is_new = np.concatenate([np.zeros(0, bool), *self._is_new])
        lasts = (visible.sum(axis=1) >= min_frames) | (objects == 0) | ~is_new
        return ObjectPoints(points[lasts], visible[lasts], objects[lasts])


class _Front(NamedTuple):
    """Followed points of an object in a frame: places, float32 (n, 2), and numbers, and what is known of the object.

    Attributes
    ----------
    places : float32 (n, 2)
        xy, px.
    numbers : integer (n,)
    motions : list of float64 (2, 3)
        Its last motions.
    contrast : float
        Median contrast of the patches of its tracks where it was last seen, grey levels.
    """

    places: np.ndarray
    numbers: np.ndarray
    motions: list[np.ndarray]
    contrast: float


_NOTHING = _Front(np.zeros((0, 2), np.float32), np.zeros(0, np.intp), [], 0.0)


def _follow(
    read_frame: Callable[[int], np.ndarray],
    order: Iterable[int],
    points: np.ndarray,
    visible: np.ndarray,
    objects: np.ndarray,
    params: ObjectPointParams,
    found: _Followed,
) -> None:
    """Follow all objects through frames in one order of time."""
    labels = np.unique(objects[objects > 0])
    fronts = dict.fromkeys(labels.tolist(), _NOTHING)
    last, gray = None, None
    for frame in order:
        last_gray, gray = gray, cv2.cvtColor(read_frame(frame), cv2.COLOR_RGB2GRAY)
        if last is not None:
            pair = FramePair(last_gray, gray, params)
            equalised = cv2.equalizeHist(last_gray)
            tracks = _Tracks.of_pair(points, visible, objects, last, frame)
            fronts = {label: tracks.follow(label, front, pair, equalised, found) for label, front in fronts.items()}
        last = frame


class _Tracks(NamedTuple):
    """The tracks that the first frame of a pair shows.

    Attributes
    ----------
    frames : (first, second)
    place0, place1 : float32 (N, 2)
        xy in both frames, px; the second is read only where `goes_on`.
    goes_on : bool (N,)
        Whether the second frame shows the track, too.
    objects : integer (N,)
    """

    frames: tuple[int, int]
    place0: np.ndarray
    place1: np.ndarray
    goes_on: np.ndarray
    objects: np.ndarray

    @classmethod
    def of_pair(cls, points, visible, objects, frame0: int, frame1: int) -> "_Tracks":
        seen = np.flatnonzero(visible[:, frame0])
        place0, place1 = points[seen, frame0], points[seen, frame1]
        return cls((frame0, frame1), place0, place1, visible[seen, frame1], objects[seen])

    def follow(self, label: int, front: _Front, pair: FramePair, equalised: np.ndarray, found: _Followed) -> _Front:
        """Follow one object to the second frame, and return what of it is followed there."""
        is_own = self.objects == label
        shown, ended, around = is_own & self.goes_on, is_own & ~self.goes_on, ~is_own & self.goes_on
        own = np.concatenate([self.place0[is_own], front.places])
        motions = pair.motions(self.place0[shown], self.place1[shown], own, front.motions)
        if not motions:
            return _NOTHING
        usual = front.contrast
        if is_own.any():
            usual = float(np.median(contrast(pair.image0, self.place0[is_own], pair.params.patch)))
        other = Surroundings(self.place0[around], self.place1[around] - self.place0[around], self.objects[around] == 0)
        lost = np.concatenate([self.place0[ended], front.places])
        there, keeps = _keep(lost, motions, other, pair, usual)
        num_ended = np.count_nonzero(keeps[: np.count_nonzero(ended)])
        numbers = np.concatenate([found.add(num_ended, label), front.numbers[keeps[np.count_nonzero(ended) :]]])
        found.see(self.frames[1], numbers, there[keeps])
        corners = new_corners(equalised, own, self.place0[~is_own], pair)
        followed, corner_numbers = self._add_corners(label, corners, own, motions, other, pair, usual, found)
        places, numbers = np.concatenate([there[keeps], followed]), np.concatenate([numbers, corner_numbers])
        return _Front(places, numbers, motions, usual)

    def _add_corners(
        self,
        label: int,
        corners: np.ndarray,
        own: np.ndarray,
        motions: list[np.ndarray],
        other: Surroundings,
        pair: FramePair,
        usual: float,
        found: _Followed,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Add corners to the object or the background; return places, xy, and numbers of the object's."""
        params = pair.params
        if not len(corners):
            return _NOTHING.places, _NOTHING.numbers
        by_object, (by_other, is_background) = pair.find(motions, corners), other.find(pair, corners)
        gain = by_object.correlation - by_other.correlation
        is_near = cKDTree(own).query(corners)[0] <= cKDTree(self.place0).query(corners)[0]
        joins = is_near & by_object.is_tracked & (by_object.correlation > params.min_corner_correlation)
        joins &= (gain > params.gain) & _are_distinct(corners, pair, usual)
        stays = is_background & by_other.is_tracked & (by_other.correlation > params.min_corner_correlation)
        stays &= gain < -params.gain
        for side, chosen, place in ((0, stays, by_other.points), (label, joins, by_object.points)):
            numbers = found.add(np.count_nonzero(chosen), side, is_new=True)
            found.see(self.frames[0], numbers, corners[chosen])
            found.see(self.frames[1], numbers, place[chosen])
        return by_object.points[joins], numbers


def _keep(
    points: np.ndarray, motions: list[np.ndarray], other: Surroundings, pair: FramePair, usual: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return where the object's motions bring points, xy, and whether their patches, of enough contrast, say so."""
    if not len(points):
        return points, np.zeros(0, bool)
    found = pair.find(motions, points)
    keeps = (found.correlation > pair.params.min_correlation) & (
        found.correlation > other.find(pair, points)[0].correlation
    )
    return found.points, keeps & _are_distinct(points, pair, usual)


def _are_distinct(points: np.ndarray, pair: FramePair, usual: float) -> np.ndarray:
    """Return whether patches around points of the first frame are no straight edges, nor much plainer than usual."""
    params = pair.params
    is_round = roundness(pair.image0, points, params.patch) >= params.min_roundness
    return is_round & (contrast(pair.image0, points, params.patch) >= params.min_contrast * usual)
