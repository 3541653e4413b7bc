"""Ordered residual kernel over many hypotheses: which of them explain each object best, and how well at that."""

import numpy as np

_GOOD = 0.02
"""Share of an object's hypotheses that are good: few enough to be of its motion, more than one lucky one."""
_LEAST_SCALE = 0.02
"""px: finer differences are rounding, of coordinates in single precision or of trackers."""


def preferred_in_common(residuals: np.ndarray, window: float, fade: float) -> np.ndarray:
    """Share of preferred hypotheses that two objects have in common, as far as these explain them.

    In each frame pair an object prefers the hypotheses of least residual, a share `window` of all. A rank says nothing
    of how well they explain it: two movers of one object each, to which no hypothesis of their own was drawn, may
    prefer the same bad ones. A preference therefore fades as ``1 / (1 + (d² - s²) / (fade s)²)`` where the distance d
    that the hypothesis leaves of the object exceeds s, which good hypotheses leave of the typical object in this pair.

    Parameters
    ----------
    residuals : floating (M, H, K)
        [pair, hypothesis, object], px²; NaN for all hypotheses of a pair where an object is absent.
    window : float
        0..1.
    fade : float
        0: ranks alone count.

    Returns
    -------
    float64 (K, K)
        Mean over the pairs that show both objects, 0..1, 1 on the diagonal; NaN where there is none.

    References
    ----------
    T.-J. Chin, H. Wang and D. Suter, "The ordered residual kernel for robust motion subspace clustering", NIPS 2009.
    """
    num_objects = residuals.shape[2]
    total, met = np.zeros((num_objects, num_objects)), np.zeros((num_objects, num_objects), dtype=np.int64)
    for pair in residuals:
        present = np.flatnonzero(~np.isnan(pair[0]))
        if not len(present):
            continue
        squared = pair.T[present].astype(np.float64)
        preferred = share_preferences(squared, window)
        preferred /= np.linalg.norm(preferred, axis=1, keepdims=True)
        if fade > 0:
            good = np.quantile(squared, _GOOD, axis=1, method="higher")
            scale = max(float(np.median(good)), _LEAST_SCALE**2)
            preferred /= 1.0 + np.maximum(squared - scale, 0.0) / (fade**2 * scale)
        both = np.ix_(present, present)
        total[both] += preferred @ preferred.T
        met[both] += 1
    # Sums of squares that are 1 but for rounding.
    kernel = np.where(met > 0, np.minimum(total / np.maximum(met, 1), 1.0), np.nan)
    np.fill_diagonal(kernel, np.where(np.diag(met) > 0, 1.0, np.nan))
    return kernel


def share_preferences(distances: np.ndarray, window: float) -> np.ndarray:
    """Weight 0..1 of each hypothesis for each object: the nearest, a share `window`, have 1.

    Equally distant hypotheses share the places that are left between them, so that their order says nothing.

    Parameters
    ----------
    distances : float (K, H)
        Any monotonic function of the residuals.
    window : float
        0..1; at least one hypothesis is preferred.

    Returns
    -------
    float64 (K, H)
        Rows of equal sums.
    """
    count = max(1, round(window * distances.shape[1]))
    last = np.partition(distances, count - 1, axis=1)[:, count - 1 : count]
    nearer, level = distances < last, distances == last
    left = count - nearer.sum(axis=1, keepdims=True)
    return nearer + level * (left / level.sum(axis=1, keepdims=True))
