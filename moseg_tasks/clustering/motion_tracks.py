"""Point tracks and what the affinity's rows own of them: the data that a number of motions is tested against."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError


class MotionTracks(NamedTuple):
    """Tracks of a stretch of frames.

    Attributes
    ----------
    points : float (N, F, 2)
        xy, px; any value where invisible.
    visible : bool (N, F)
    owner : int (N,)
        Row of the affinity that each track belongs to: its object, or at trajectory level the track itself.
    """

    points: np.ndarray
    visible: np.ndarray
    owner: np.ndarray


def frame_pairs(num_frames: int, gap: int) -> list[tuple[int, int]]:
    """Pairs of frames `gap` apart, or as far as a shorter stretch allows."""
    gap = min(gap, num_frames - 1)
    return [(frame, frame + gap) for frame in range(num_frames - gap)] if gap > 0 else []


def check_tracks(tracks: MotionTracks, num_owners: int) -> None:
    """Raise InputError where the arrays of `tracks` disagree or name an owner outside 0 .. num_owners - 1."""
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
