"""The ordered residual kernel between nodes over many hypotheses: alike is what prefers the same hypotheses."""

import numpy as np

from moseg.schemas.errors import InputError
from moseg.tasks.affinity.preferences import share_preferences


def preference_kernel(residuals: np.ndarray, window: float, noise_floor: float) -> np.ndarray:
    """Share of preferred hypotheses that two nodes have in common.

    In each frame pair a node prefers the hypotheses of least residual, a share `window` of all. Those that leave the
    same residual, or all less than the noise, share the places that are left between them: of hypotheses that explain
    a node equally well, rounding must not choose.

    Parameters
    ----------
    residuals : floating (M, H, N)
        [pair, hypothesis, node], px², infinite where a hypothesis is none; NaN for all hypotheses of a pair where a
        node is absent.
    window : float
        0..1.
    noise_floor : float
        px.

    Returns
    -------
    float64 (N, N)
        Mean over the pairs that show both nodes of the cosine between their preferences, 0..1; NaN where there is none.

    Raises
    ------
    InputError
        Where the residuals are not (M, H, N) with H at least 1.

    References
    ----------
    T.-J. Chin, H. Wang and D. Suter, "The ordered residual kernel for robust motion subspace clustering", NIPS 2009.
    """
    if residuals.ndim != 3 or residuals.shape[1] == 0:
        raise InputError("wrong shape of residuals", where="preferences", got=residuals.shape, expected="(M, H, N)")
    num_nodes = residuals.shape[2]
    total, met = np.zeros((num_nodes, num_nodes)), np.zeros((num_nodes, num_nodes), dtype=np.int64)
    for pair in residuals:
        present = ~np.isnan(pair[0])
        preferred = share_preferences(np.maximum(pair.T[present], noise_floor**2), window)
        preferred /= np.linalg.norm(preferred, axis=1, keepdims=True)
        both = np.ix_(present, present)
        total[both] += preferred @ preferred.T
        met[both] += 1
    return np.where(met > 0, total / np.maximum(met, 1), np.nan)
