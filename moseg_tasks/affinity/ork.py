"""The paper's weighted ordered-residual kernel (ORK) between objects."""

import numpy as np

from moseg.schemas.parameters import AffinityParams


def ork_affinity(residuals: np.ndarray, params: AffinityParams) -> np.ndarray:
    """Return the weighted ORK: objects are alike if the same residuals are among their smallest.

    In each frame pair residuals are ranked from 0 and scored ``max(t - rank, 0)``; the affinity of two objects is the
    product of their score vectors. The text has two possible readings. ``models``: rank the models for each object's
    data, so objects are alike if the same models explain them (Chin's kernel). ``objects``: rank the objects under each
    object's model. Equal residuals share their mean rank, so that the order of the objects has no effect.

    Parameters
    ----------
    residuals : float64 (M, K, K)
        [pair, model, data]; NaN if the model is invalid or the object absent.
    params : AffinityParams
        `ork_threshold` (t) and `ork_reading` are read.

    Returns
    -------
    float64 (K, K)
        Mean over the pairs that contain both objects (the sum of the paper is equivalent if no object is ever missing);
        NaN if there is none. Not normalised: between 0 and t (t + 1) (2 t + 1) / 6, where t is an integer.

    References
    ----------
    T.-J. Chin, H. Wang and D. Suter, "The ordered residual kernel for robust motion subspace clustering", NIPS 2009.
    """
    total = np.zeros(residuals.shape[1:])
    met = np.zeros(residuals.shape[1:], dtype=np.int64)
    for pair in residuals:
        rows = pair.T if params.ork_reading == "models" else pair
        known = np.isfinite(rows)
        scores = np.where(known, np.maximum(params.ork_threshold - mean_ranks(rows), 0.0), 0.0)
        present = known.any(axis=1)
        total += scores @ scores.T
        met += present[:, None] & present[None, :]
    return np.where(met > 0, total / np.maximum(met, 1), np.nan)


def mean_ranks(rows: np.ndarray) -> np.ndarray:
    """Return the ranks from 0 of each row's finite values, with mean ranks for equal ones; any value elsewhere."""
    smaller = (rows[:, None, :] < rows[:, :, None]).sum(axis=2)
    equal = (rows[:, None, :] == rows[:, :, None]).sum(axis=2)
    return smaller + (equal - 1) / 2.0
