"""Static candidates: groups of tracks that may move and show too little or no evidence of it."""

import numpy as np


def static_candidates(
    objects: np.ndarray, is_moving: np.ndarray, surface: np.ndarray, max_candidates: int
) -> np.ndarray:
    """Return the static candidate of each track: objects with too little evidence first, then the largest surfaces.

    Parameters
    ----------
    objects : integer (track,)
        1.. by falling score, as `judge_objects` returns them; 0 = none.
    is_moving : bool (object,)
        Of objects 1, 2, ...
    surface : integer (track,)
        1.. by falling number of tracks; 0 = none. Tracks of objects are not taken from them.
    max_candidates : int

    Returns
    -------
    uint16 (track,)
        The object's number, or the surface's plus the number of objects; 0 = none. What has no number in uint16 is left
        out.
    """
    moves = np.concatenate([[False], is_moving])[objects]
    of_surface = np.where(surface > 0, len(is_moving) + surface.astype(np.int64), 0)
    number = np.where(objects > 0, objects, of_surface)
    number[moves | (number > np.iinfo(np.uint16).max)] = 0
    first = np.unique(number[number > 0])[:max_candidates]
    return np.where(np.isin(number, first), number, 0).astype(np.uint16)
