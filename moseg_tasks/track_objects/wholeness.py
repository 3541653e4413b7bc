"""Whole objects: a group of moving tracks takes the rest of the surface that it has a good part of."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import TrackObjectParams


class WholeObjects(NamedTuple):
    """Groups of tracks with the rest of their surfaces.

    Attributes
    ----------
    group : int64 (track,)
        From 0; -1 = none.
    on_surface : float64 (group,)
        Share of each group's tracks that lie on such surfaces.
    """

    group: np.ndarray
    on_surface: np.ndarray


def complete_objects(group: np.ndarray, surface: np.ndarray, params: TrackObjectParams) -> WholeObjects:
    """Return groups of tracks with the other tracks of their surfaces.

    A car that comes along its epipolar lines shows that it moves where it meets the ground, and hardly elsewhere. But
    all its tracks lie on one surface: they seem equally near.

    Parameters
    ----------
    group : integer (track,)
        As `regroup_candidates` returns it: from 0; -1 = none.
    surface : integer (track,)
        0 = none.
    params : TrackObjectParams
        `min_surface` is read.
    """
    whole = np.asarray(group, np.int64).copy()
    num_on_surface = np.zeros(int(whole.max(initial=-1)) + 1)
    for number in range(1, int(surface.max(initial=0)) + 1):
        tracks = np.flatnonzero(surface == number)
        owners = group[tracks[group[tracks] >= 0]]
        if not len(owners):
            continue
        counts = np.bincount(owners)
        owner = counts.argmax()
        if counts[owner] >= params.min_surface * len(tracks):
            whole[tracks[group[tracks] < 0]] = owner
            num_on_surface[owner] += np.count_nonzero(whole[tracks] == owner)
    num_tracks = np.bincount(whole[whole >= 0], minlength=len(num_on_surface))
    return WholeObjects(whole, num_on_surface / np.maximum(num_tracks, 1))
