"""The active tracks of one frame, and their check against the objects' masks."""

from typing import NamedTuple

import cv2
import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import TrackParams
from moseg.tasks.tracks.corners import texture_strength
from moseg.tasks.tracks.labels_at import labels_at
from moseg.tasks.tracks.sampling import sample_points

BACKGROUND = 0


class Front(NamedTuple):
    """The active tracks of one frame.

    Attributes
    ----------
    track : intp (P,)
        Index among all tracks.
    points : float32 (P, 2)
        xy, px.
    object : uint16 (P,)
    num_tracks : int
        Tracks begun so far, active or not.
    """

    track: np.ndarray
    points: np.ndarray
    object: np.ndarray
    num_tracks: int

    def move(self, points: np.ndarray, found: np.ndarray) -> "Front":
        """Return the front in the next frame: `points` (P, 2), only those that were `found` (P,)."""
        return Front(self.track[found], points[found], self.object[found], self.num_tracks)


NO_TRACKS = Front(np.zeros(0, np.intp), np.zeros((0, 2), np.float32), np.zeros(0, np.uint16), 0)


def check_front(
    front: Front, frame_index: int, image: np.ndarray, mask: np.ndarray, params: TrackParams, rng: np.random.Generator
) -> Front:
    """Drop points outside their object's mask and sample new ones until each object has its quota.

    Parameters
    ----------
    front : Front
    frame_index : int
        Index of the frame in errors.
    image : uint8 (y, x, 3)
        RGB.
    mask : uint16 (y, x)
        Objects, 0 = background, which has a quota as well.
    params : TrackParams
    rng : numpy.random.Generator

    Returns
    -------
    Front
        Continued tracks, then the new ones by object.

    Raises
    ------
    InputError
        The frame and its mask differ in size.
    """
    if mask.shape != image.shape[:2]:
        where = f"mask of frame {frame_index}"
        raise InputError("wrong size of mask", where=where, got=mask.shape, expected=image.shape[:2])
    front = front.move(front.points, labels_at(mask, front.points) == front.object)
    texture = texture_strength(cv2.cvtColor(image, cv2.COLOR_RGB2GRAY))
    for label in np.flatnonzero(np.bincount(mask.ravel())):
        quota = params.background_points if label == BACKGROUND else params.points_per_object
        taken = front.points[front.object == label]
        points = sample_points(texture, mask == label, quota, taken, params, rng)
        front = Front(
            np.concatenate([front.track, front.num_tracks + np.arange(len(points))]),
            np.concatenate([front.points, points]),
            np.concatenate([front.object, np.full(len(points), label, dtype=np.uint16)]),
            front.num_tracks + len(points),
        )
    return front
