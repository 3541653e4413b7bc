"""k-medoids of an object's pixels, which cover it evenly."""

import numpy as np

from moseg.tasks.tracks.spacing import far_from


def covering_medoids(
    mask: np.ndarray,
    num_points: int,
    *,
    num_candidates: int,
    spacing: float,
    taken: np.ndarray,
    rng: np.random.Generator,
) -> np.ndarray:
    """Return medoids of a random sample of a mask's pixels, at a distance from existing points.

    Parameters
    ----------
    mask : bool (y, x)
    num_points : int
        Maximal number of medoids.
    num_candidates : int
        Pixels drawn: the cost grows with their square.
    spacing : float
        Minimal distance of a candidate to existing points, px.
    taken : float32 (M, 2)
        xy of existing points, px.
    rng : numpy.random.Generator

    Returns
    -------
    points : float32 (P, 2)
        P <= num_points.

    References
    ----------
    H.-S. Park and C.-H. Jun, A simple and fast algorithm for k-medoids clustering, 2009;
    E. Schubert and P. Rousseeuw, Fast and eager k-medoids clustering, 2021 (FasterPAM).
    """
    # Imported here, because it imports scikit-learn: half a second, also for processes that only read results.
    import kmedoids

    y, x = np.nonzero(mask)
    drawn = rng.choice(len(x), size=min(num_candidates, len(x)), replace=False)
    candidates = np.stack([x[drawn], y[drawn]], axis=1).astype(np.float32)
    candidates = candidates[far_from(candidates, taken, spacing)]
    num_points = min(num_points, len(candidates))
    if num_points == 0:
        return np.zeros((0, 2), dtype=np.float32)
    distances = np.linalg.norm(candidates[:, None] - candidates[None], axis=-1)
    seed = int(rng.integers(2**31))
    result = kmedoids.fasterpam(distances, num_points, init="random", random_state=seed, n_cpu=1)
    return candidates[np.sort(result.medoids)]
