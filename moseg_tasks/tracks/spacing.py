"""Point sets that keep their distance."""

import numpy as np


def spaced_subset(candidates: np.ndarray, num_points: int, spacing: float, taken: np.ndarray) -> np.ndarray:
    """The first candidates that lie apart from each other and from points already there.

    Parameters
    ----------
    candidates : float32 (C, 2)
        In order of preference.
    num_points : int
        Most points returned.
    spacing : float
        Least distance, px.
    taken : float32 (M, 2)

    Returns
    -------
    points : float32 (P, 2)
        P <= num_points.
    """
    free = candidates[far_from(candidates, taken, spacing)]
    chosen = []
    while len(free) and len(chosen) < num_points:
        chosen.append(free[0])
        free = free[far_from(free, free[:1], spacing)]
    return np.array(chosen, dtype=np.float32).reshape(-1, 2)


def far_from(points: np.ndarray, others: np.ndarray, spacing: float) -> np.ndarray:
    """Which points (N, 2) lie at least `spacing` px from every one of `others` (M, 2): bool (N,)."""
    far = np.ones(len(points), dtype=bool)
    for other in others:
        far &= np.sum((points - other) ** 2, axis=1) >= spacing**2
    return far
