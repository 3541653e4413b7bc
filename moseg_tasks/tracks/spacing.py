"""Point sets with a minimal distance."""

import numpy as np


def spaced_subset(candidates: np.ndarray, num_points: int, spacing: float, taken: np.ndarray) -> np.ndarray:
    """Return the first candidates that are apart from each other and from existing points.

    Parameters
    ----------
    candidates : float32 (C, 2)
        In order of preference.
    num_points : int
        Maximal number of points.
    spacing : float
        Minimal distance, px.
    taken : float32 (M, 2)

    Returns
    -------
    points : float32 (P, 2)
        P <= num_points.
    """
    free = candidates[far_from(candidates, taken, spacing)]
    x, y = np.ascontiguousarray(free.T)
    chosen = []
    while len(x) and len(chosen) < num_points:
        chosen.append((x[0], y[0]))
        far = _are_far(x, y, x[0], y[0], spacing)
        x, y = x[far], y[far]
    return np.array(chosen, dtype=np.float32).reshape(-1, 2)


def far_from(points: np.ndarray, others: np.ndarray, spacing: float) -> np.ndarray:
    """Return which points (N, 2) lie at least `spacing` px from every one of `others` (M, 2): bool (N,)."""
    far = np.ones(len(points), dtype=bool)
    x, y = np.ascontiguousarray(points.T)
    for other_x, other_y in others:
        far &= _are_far(x, y, other_x, other_y, spacing)
    return far


def _are_far(x, y, other_x, other_y, spacing: float) -> np.ndarray:
    dx, dy = x - other_x, y - other_y
    return dx * dx + dy * dy >= spacing**2
