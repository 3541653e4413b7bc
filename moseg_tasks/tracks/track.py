"""Object-specific point tracks through one section of a video."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import cv2
import numpy as np

from moseg_tasks.tracks.corners import texture_strength
from moseg_tasks.tracks.labels_at import labels_at
from moseg_tasks.tracks.lucas_kanade import follow_points
from moseg_tasks.tracks.sampling import sample_points
from schemas.errors import InputError
from schemas.parameters import TrackParams

BACKGROUND = 0


class Tracks(NamedTuple):
    """Point tracks through F frames.

    Attributes
    ----------
    points : float32 (N, F, 2)
        xy, px; 0 where not visible.
    visible : bool (N, F)
        One run of frames a track.
    object : uint16 (N,)
        The object in which the track was sampled.
    """

    points: np.ndarray
    visible: np.ndarray
    object: np.ndarray


class _Front(NamedTuple):
    """The tracks alive in one frame: index, xy (float32, px) and object of each."""

    track: np.ndarray
    points: np.ndarray
    object: np.ndarray

    def keep(self, kept: np.ndarray) -> "_Front":
        return _Front(self.track[kept], self.points[kept], self.object[kept])


def track_points(
    frames: Iterable[np.ndarray],
    masks: Sequence[np.ndarray] | np.ndarray,
    params: TrackParams,
    rng: np.random.Generator,
) -> Tracks:
    """Sample points in every object and follow them.

    At the first frame and every `params.resample_every` frames, points outside their object's mask are dropped (their
    tracks stay as they were before) and new ones sampled until each object has its quota again, so that an object that
    enters gets points at the next check. A point that is lost or nears the frame's border ends its track.

    The paper follows points by PIPs; here it is pyramidal Lucas-Kanade with a forward-backward check, which needs no
    weights.

    Parameters
    ----------
    frames : iterable of uint8 (y, x, 3)
        RGB, F frames; read once, in order.
    masks : uint16 (M, y, x)
        Objects in the first M <= F frames, 0 = background, which gets points as well. Later frames only extend tracks.
    params : TrackParams
    rng : numpy.random.Generator

    Returns
    -------
    Tracks
        In order of first frame, then object.

    Raises
    ------
    InputError
        Where a frame and its mask differ in size, or there are fewer frames than masks.
    """
    front = _Front(np.zeros(0, np.intp), np.zeros((0, 2), np.float32), np.zeros(0, np.uint16))
    fronts: list[_Front] = []
    num_tracks = 0
    previous = None
    for frame_index, frame in enumerate(frames):
        gray = cv2.cvtColor(frame, cv2.COLOR_RGB2GRAY)
        if previous is not None:
            points, found = follow_points(previous, gray, front.points, params)
            front = front._replace(points=points).keep(found)
        if frame_index < len(masks) and frame_index % params.resample_every == 0:
            mask = masks[frame_index]
            if mask.shape != gray.shape:
                where = f"mask of frame {frame_index}"
                raise InputError("wrong size of mask", where=where, got=mask.shape, expected=gray.shape)
            front = front.keep(labels_at(mask, front.points) == front.object)
            front = _replenish(front, num_tracks, gray, mask, params, rng)
            num_tracks = max(num_tracks, front.track.max(initial=-1) + 1)
        fronts.append(front)
        previous = gray
    if len(fronts) < len(masks):
        raise InputError("fewer frames than masks", where="frames", got=len(fronts), expected=f"at least {len(masks)}")
    return _assemble(fronts, num_tracks)


def _replenish(front: _Front, num_tracks: int, gray, mask, params: TrackParams, rng: np.random.Generator) -> _Front:
    """The front with each object of the mask filled up to its quota."""
    texture = texture_strength(gray)
    for label in np.unique(mask):
        quota = params.background_points if label == BACKGROUND else params.points_per_object
        taken = front.points[front.object == label]
        points = sample_points(texture, mask == label, quota, taken, params, rng)
        front = _Front(
            np.concatenate([front.track, num_tracks + np.arange(len(points))]),
            np.concatenate([front.points, points]),
            np.concatenate([front.object, np.full(len(points), label, dtype=np.uint16)]),
        )
        num_tracks += len(points)
    return front


def _assemble(fronts: list[_Front], num_tracks: int) -> Tracks:
    tracks = Tracks(
        points=np.zeros((num_tracks, len(fronts), 2), dtype=np.float32),
        visible=np.zeros((num_tracks, len(fronts)), dtype=bool),
        object=np.zeros(num_tracks, dtype=np.uint16),
    )
    for frame_index, front in enumerate(fronts):
        tracks.points[front.track, frame_index] = front.points
        tracks.visible[front.track, frame_index] = True
        tracks.object[front.track] = front.object
    return tracks
