"""Points that are followed, without those in graphics, which would follow the filling."""

import numpy as np


def pairs_outside(pair: tuple[np.ndarray, np.ndarray], hidden: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the points of a pair of frames that are hidden in neither.

    Parameters
    ----------
    pair : two float (N, 2)
        xy of the same points in both frames, px.
    hidden : bool (y, x)

    Returns
    -------
    two float (M, 2)
    """
    seen = ~(_are_inside(pair[0], hidden) | _are_inside(pair[1], hidden))
    return pair[0][seen], pair[1][seen]


def end_hidden(points: np.ndarray, visible: np.ndarray, hidden: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """End each track where it goes behind a graphic, and drop those that begin there.

    Parameters
    ----------
    points : float32 (track, frame, 2)
        xy, px; 0 where not visible.
    visible : bool (track, frame)
        One run of frames per track.
    hidden : bool (y, x)

    Returns
    -------
    points, visible
        Of the tracks that are still seen in two frames.
    """
    inside = visible & _are_inside(points, hidden)
    seen = visible & ~np.logical_or.accumulate(inside, axis=1)
    kept = seen.sum(axis=1) >= 2
    return np.where(seen[kept, :, None], points[kept], np.float32(0)), seen[kept]


def _are_inside(points: np.ndarray, hidden: np.ndarray) -> np.ndarray:
    """Return whether points (..., 2) lie in a mask bool (y, x), bool (...)."""
    x, y = (np.clip(np.rint(points[..., axis]).astype(int), 0, hidden.shape[1 - axis] - 1) for axis in (0, 1))
    return hidden[y, x]
