"""Point tracks and the affinity rows that own them: the data by which a number of motions is found."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError


class MotionTracks(NamedTuple):
    """Tracks of consecutive frames.

    Attributes
    ----------
    points : float (N, F, 2)
        xy, px; any value if invisible.
    visible : bool (N, F)
    owner : int (N,)
        Row of the affinity of each track: its object, or for trajectories the track itself.
    """

    points: np.ndarray
    visible: np.ndarray
    owner: np.ndarray


def frame_pairs(num_frames: int, gap: int) -> list[tuple[int, int]]:
    """Return pairs of frames with distance `gap`, or the largest distance of fewer frames."""
    gap = min(gap, num_frames - 1)
    return [(frame, frame + gap) for frame in range(num_frames - gap)] if gap > 0 else []


def check_tracks(tracks: MotionTracks, num_owners: int) -> None:
    """Raise InputError if the arrays of `tracks` disagree or contain an owner outside 0 .. num_owners - 1."""
    points, visible, owner = tracks
    if np.ndim(points) != 3 or points.shape[2] != 2 or visible.shape != points.shape[:2]:
        raise InputError(
            "wrong shape of tracks",
            where="motion tracks",
            got=(np.shape(points), np.shape(visible)),
            expected="(N, F, 2) and (N, F)",
        )
    if owner.shape != (len(points),) or (len(owner) and not 0 <= owner.min() <= owner.max() < num_owners):
        raise InputError(
            "tracks belong to nothing", where="motion tracks", got=owner, expected=f"(N,) of 0 .. {num_owners - 1}"
        )
