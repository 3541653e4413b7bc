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
    is_on_surface : bool (track,)
        Whether it lies on a surface of which its group has a good part.
    on_surface : float64 (group,)
        Share of such tracks in each group, with the rest.
    """

    group: np.ndarray
    is_on_surface: np.ndarray
    on_surface: np.ndarray


def complete_objects(group: np.ndarray, surface: np.ndarray, params: TrackObjectParams) -> WholeObjects:
    """Return groups of tracks with the other tracks of their surfaces.

    A car that comes along its epipolar lines shows that it moves where it meets the ground, and hardly elsewhere. But
    all its tracks lie on one surface: they seem equally near. Of several groups on a surface, the one with most of its
    tracks takes the rest, and the others keep theirs.

    Parameters
    ----------
    group : integer (track,)
        As `regroup_candidates` returns it: from 0; -1 = none.
    surface : integer (track,)
        0 = none.
    params : TrackObjectParams
        `min_surface` is read.

    Returns
    -------
    WholeObjects
    """
    group, surface = np.asarray(group, np.int64), np.asarray(surface, np.int64)
    num_groups = int(group.max(initial=-1)) + 1
    of_surface, of_group = _good_parts(group, surface, num_groups, params.min_surface)
    # The largest part of a surface is written last; of equal ones, that of the lowest group.
    owner = np.full(surface.max(initial=0) + 1, -1)
    owner[of_surface] = of_group
    whole = np.where(group < 0, owner[surface], group)
    good = of_surface * num_groups + of_group
    is_on_surface = (surface > 0) & (whole >= 0) & np.isin(surface * num_groups + whole, good)
    return WholeObjects(whole, is_on_surface, share_of_groups(is_on_surface, whole, num_groups))


def share_of_groups(holds: np.ndarray, group: np.ndarray, num_groups: int) -> np.ndarray:
    """Return the share of each group's tracks for which something holds, float64 (group,); 0 where it has none."""
    num_tracks = np.bincount(group[group >= 0], minlength=num_groups)
    return np.bincount(group[holds & (group >= 0)], minlength=num_groups) / np.maximum(num_tracks, 1)


def _good_parts(
    group: np.ndarray, surface: np.ndarray, num_groups: int, min_share: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return surface and group of the parts, of at least `min_share` of a surface, in rising order of size: int64."""
    size = np.bincount(surface, minlength=1)
    is_shared = (surface > 0) & (group >= 0)
    shared, count = np.unique(surface[is_shared] * num_groups + group[is_shared], return_counts=True)
    of_surface, of_group = np.divmod(shared, max(num_groups, 1))
    rising = np.lexsort((-of_group, count))
    rising = rising[count[rising] >= min_share * size[of_surface[rising]]]
    return of_surface[rising], of_group[rising]
