"""Ordered residual kernels over many hypotheses: two objects are alike if the same hypotheses explain both best."""

import numpy as np

from moseg.schemas.errors import InputError

_GOOD = 0.02
"""Share of an object's hypotheses that are good: few enough to be of its motion, more than one lucky one."""
_MIN_SCALE = 0.02
"""px: finer differences are rounding, of coordinates in single precision or of trackers."""


class _MeanCosine:
    """Mean over frame pairs of the cosine between the preferences of each two of K objects."""

    def __init__(self, num_objects: int):
        self._total = np.zeros((num_objects, num_objects))
        self.num_pairs = np.zeros((num_objects, num_objects), dtype=np.int64)

    def add(self, present: np.ndarray, preferred: np.ndarray) -> None:
        """Add a pair: weights float64 (P, H) of the hypotheses for the objects int (P,) that are present."""
        both = np.ix_(present, present)
        self._total[both] += preferred @ preferred.T
        self.num_pairs[both] += 1

    def mean(self) -> np.ndarray:
        """Return the mean, float64 (K, K); NaN where no pair shows both objects."""
        return np.where(self.num_pairs > 0, self._total / np.maximum(self.num_pairs, 1), np.nan)


def preference_kernel(residuals: np.ndarray, window: float, noise_floor: float) -> np.ndarray:
    """Return the share of preferred hypotheses that two objects have in common.

    In each frame pair an object prefers the hypotheses of smallest residual, a share `window` of all. Hypotheses of
    equal residual, or of any residual below the noise, share the remaining places: among hypotheses that explain an
    object equally well, rounding must not choose.

    Parameters
    ----------
    residuals : floating (M, H, K)
        [pair, hypothesis, object], px², infinite for a hypothesis without a model; NaN for all hypotheses of a pair
        where an object is absent.
    window : float
        0..1.
    noise_floor : float
        px.

    Returns
    -------
    float64 (K, K)
        Mean over the pairs that show both objects of the cosine between their preferences, 0..1; NaN where there is
        none.

    Raises
    ------
    InputError
        If the residuals are not (M, H, K) with H at least 1.

    References
    ----------
    T.-J. Chin, H. Wang and D. Suter, "The ordered residual kernel for robust motion subspace clustering", NIPS 2009.
    """
    if residuals.ndim != 3 or residuals.shape[1] == 0:
        raise InputError("wrong shape of residuals", where="preferences", got=residuals.shape, expected="(M, H, N)")
    cosine = _MeanCosine(residuals.shape[2])
    for pair in residuals:
        present = np.flatnonzero(~np.isnan(pair[0]))
        cosine.add(present, _unit_preferences(np.maximum(pair.T[present], noise_floor**2), window))
    return cosine.mean()


def fading_preference_kernel(residuals: np.ndarray, window: float, fade: float) -> np.ndarray:
    """Return the share of preferred hypotheses that two objects have in common, weighted by how well they fit.

    In each frame pair an object prefers the hypotheses of smallest residual, a share `window` of all. A rank does not
    show how well they explain it: two movers of one object each, for which no hypothesis of their own was drawn, may
    prefer the same bad ones. A preference is therefore weighted by ``1 / (1 + (d² - s²) / (fade s)²)`` where the
    residual d of the object exceeds s, the residual of good hypotheses for the typical object in this pair.

    Parameters
    ----------
    residuals : floating (M, H, K)
        [pair, hypothesis, object], px²; NaN for all hypotheses of a pair where an object is absent.
    window : float
        0..1.
    fade : float
        0: only ranks count.

    Returns
    -------
    float64 (K, K)
        Mean over the pairs that show both objects, 0..1, 1 on the diagonal; NaN where there is none.

    References
    ----------
    As for `preference_kernel`.
    """
    cosine = _MeanCosine(residuals.shape[2])
    for pair in residuals:
        present = np.flatnonzero(~np.isnan(pair[0]))
        if not len(present):
            continue
        squared = pair.T[present].astype(np.float64)
        preferred = _unit_preferences(squared, window)
        if fade > 0:
            good = np.quantile(squared, _GOOD, axis=1, method="higher")
            scale = max(float(np.median(good)), _MIN_SCALE**2)
            preferred /= 1.0 + np.maximum(squared - scale, 0.0) / (fade**2 * scale)
        cosine.add(present, preferred)
    # Sums of squares that are 1 up to rounding.
    kernel = np.minimum(cosine.mean(), 1.0)
    np.fill_diagonal(kernel, np.where(np.diag(cosine.num_pairs) > 0, 1.0, np.nan))
    return kernel


def _unit_preferences(distances: np.ndarray, window: float) -> np.ndarray:
    """Return `share_preferences` with rows of unit length."""
    preferred = share_preferences(distances, window)
    preferred /= np.linalg.norm(preferred, axis=1, keepdims=True)
    return preferred


def share_preferences(distances: np.ndarray, window: float) -> np.ndarray:
    """Return the weight 0..1 of each hypothesis for each object: 1 for the nearest, a share `window` of all.

    Equally distant hypotheses share the remaining places, so that their order has no effect.

    Parameters
    ----------
    distances : float (K, H)
        Any increasing function of the residuals.
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
