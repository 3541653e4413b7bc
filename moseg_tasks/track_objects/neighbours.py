"""Pairs of tracks that are neighbours in a frame, and how far their motions differ."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree


class NearPairs(NamedTuple):
    """Pairs of a track and one of its nearest tracks in a frame.

    Attributes
    ----------
    track0, track1 : int64 (pair,)
    distance : float32 (pair,)
        px.
    difference : float32 (pair,)
        Length of the difference of the two motions to the other frame, px.
    speed0, speed1 : float32 (pair,)
        Lengths of the motions, px.
    seen : int64 (n,)
        Tracks that are visible in both frames.
    """

    track0: np.ndarray
    track1: np.ndarray
    distance: np.ndarray
    difference: np.ndarray
    speed0: np.ndarray
    speed1: np.ndarray
    seen: np.ndarray


def near_pairs(
    points: np.ndarray,
    visible: np.ndarray,
    tracks: np.ndarray,
    frames: tuple[int, int],
    num_neighbours: int,
    radius: float = np.inf,
) -> NearPairs | None:
    """Return the nearest tracks of each track in a frame, of those that are visible in another frame too.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px.
    visible : bool (track, frame)
    tracks : int64 (n,)
        Tracks that are compared.
    frames : (int, int)
        Frame whose distances count, and the frame to which motions are measured, earlier or later.
    num_neighbours : int
        Nearest tracks of each track, without itself.
    radius : float
        Distance in px from which tracks are no neighbours.

    Returns
    -------
    NearPairs or None
        None where fewer than two tracks are visible.
    """
    frame, other = frames
    seen = tracks[visible[tracks, frame] & visible[tracks, other]]
    num_neighbours = min(num_neighbours, len(seen) - 1)
    if num_neighbours < 1:
        return None
    place = points[seen, frame]
    motion = points[seen, other] - place
    distance, near = cKDTree(place).query(place, k=num_neighbours + 1, distance_upper_bound=radius)
    # The nearest one is the track itself.
    distance, near = distance[:, 1:].ravel(), near[:, 1:].ravel()
    found = np.isfinite(distance)
    own, near = np.repeat(np.arange(len(seen)), num_neighbours)[found], near[found]
    speed = np.hypot(motion[:, 0], motion[:, 1])
    difference = motion[near] - motion[own]
    return NearPairs(
        track0=seen[own],
        track1=seen[near],
        distance=distance[found],
        difference=np.hypot(difference[:, 0], difference[:, 1]),
        speed0=speed[own],
        speed1=speed[near],
        seen=seen,
    )
