"""The vehicle that carries the camera: what rides along at the lower edge of the picture is no moving object."""

import numpy as np

from moseg.schemas.parameters import OwnVehicleParams
from moseg.tasks.track_objects.regroup import RegroupedTracks

_BINS = 32
"""Columns of the picture in which the width of the vehicle is counted."""
_MOST = 0.9
"""Share of a group's tracks that must lie in the lowest part of the picture."""
_EDGE, _AT_EDGE = 0.05, 0.1
"""Height above the lower edge, of the picture's, and the share of a group's tracks that must lie there."""
_FAST = 75
"""Percentile of the motions around the vehicle that it is compared with: some of them are of its own tracks."""
_MIN_AROUND = 20
"""Fewest tracks of no group in the lowest part of the picture, whose motion the vehicle's is compared with."""


def without_own_vehicle(
    groups: RegroupedTracks, points: np.ndarray, visible: np.ndarray, shape: tuple[int, int], params: OwnVehicleParams
) -> RegroupedTracks:
    """Return groups of tracks without those of the vehicle that carries the camera, such as its bonnet.

    Its parts move on their own as much as any car, but are not wanted. They
    lie at the lower edge of the picture and stay there, while the ground beside them passes, and together they are
    wide: a car ahead, or whoever walks before the camera, is seldom all of that.

    Parameters
    ----------
    groups : RegroupedTracks
    points : floating (track, frame, xy)
        px of the picture; read only where `visible`.
    visible : bool (track, frame)
    shape : (height, width)
        Of the picture, px.
    params : OwnVehicleParams

    Returns
    -------
    RegroupedTracks
        Tracks of the vehicle have no group. As it is where no vehicle is found.
    """
    height, width = shape
    place, speed = _places_and_speeds(points, visible)
    is_seen = visible.any(axis=1)
    is_low = place[:, 1] >= (1 - params.height) * height
    is_at_edge = place[:, 1] >= (1 - _EDGE) * height
    around = speed[is_low & (groups.group < 0) & np.isfinite(speed)]
    if len(around) < _MIN_AROUND:
        return groups
    slow = params.max_motion * np.percentile(around, _FAST)
    stays = np.zeros(len(groups.is_static), bool)
    for number in range(len(stays)):
        own = is_seen & (groups.group == number)
        if own.any() and is_low[own].mean() >= _MOST and is_at_edge[own].mean() >= _AT_EDGE:
            moved = speed[own & np.isfinite(speed)]
            stays[number] = bool(len(moved)) and np.median(moved) <= slow
    across = place[np.append(stays, False)[groups.group] & is_seen, 0]
    columns = np.clip(across * (_BINS / width), 0, _BINS - 1).astype(int)
    if len(np.unique(columns)) < params.min_width * _BINS:
        return groups
    return RegroupedTracks(
        np.append(np.where(stays, -1, np.cumsum(~stays) - 1), -1)[groups.group], groups.is_static[~stays]
    )


def _places_and_speeds(points: np.ndarray, visible: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the median place of each track, xy, and its median motion, px/frame; NaN without two frames in a row."""
    seen = np.where(visible[..., None], points.astype(np.float64), np.nan)
    moved = np.linalg.norm(np.diff(seen, axis=1), axis=2)
    is_seen, has_moved = visible.any(axis=1), np.isfinite(moved).any(axis=1)
    place, speed = np.full((len(points), 2), np.nan), np.full(len(points), np.nan)
    place[is_seen] = np.nanmedian(seen[is_seen], axis=1)
    speed[has_moved] = np.nanmedian(moved[has_moved], axis=1)
    return place, speed
