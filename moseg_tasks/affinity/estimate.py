"""Motion affinity between objects from the residuals of one model over all frame pairs."""

import numpy as np

from moseg_tasks.affinity.ork import ork_affinity
from moseg_tasks.affinity.residual import residual_affinity
from schemas.errors import InputError
from schemas.parameters import AffinityParams


def estimate_affinity(residuals: np.ndarray, params: AffinityParams) -> np.ndarray:
    """Affinity of each two objects by the method that the parameters name.

    Parameters
    ----------
    residuals : float64 (M, K, K)
        [pair, model object, data object], px²; NaN where unknown.
    params : AffinityParams

    Returns
    -------
    float64 (K, K)
        Symmetric. NaN where two objects were never seen together: missing is not zero, the clustering decides.

    Raises
    ------
    InputError
        Where the residuals are not (M, K, K).
    """
    if residuals.ndim != 3 or residuals.shape[1] != residuals.shape[2]:
        raise InputError("wrong shape of residuals", where="affinity", got=residuals.shape, expected="(M, K, K)")
    method = ork_affinity if params.method == "ork" else residual_affinity
    return method(residuals, params)
