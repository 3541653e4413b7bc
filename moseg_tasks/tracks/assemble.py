"""Tracks of a section, assembled from the active points of each frame."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.tasks.tracks.front import Front


class Tracks(NamedTuple):
    """Point tracks through F frames.

    Attributes
    ----------
    points : float32 (N, F, 2)
        xy, px; 0 where not visible.
    visible : bool (N, F)
        One run of consecutive frames per track, except by BootsTAPIR.
    object : uint16 (N,)
        The object in which the track was sampled.
    """

    points: np.ndarray
    visible: np.ndarray
    object: np.ndarray


def assemble_tracks(fronts: Sequence[Front], num_masks: int) -> Tracks:
    """Assemble tracks from their positions in each frame.

    Raises
    ------
    InputError
        There are fewer frames than masks.
    """
    if len(fronts) < num_masks:
        raise InputError("fewer frames than masks", where="frames", got=len(fronts), expected=f"at least {num_masks}")
    num_tracks = fronts[-1].num_tracks if fronts else 0
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
