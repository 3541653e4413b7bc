"""Motion affinity between objects from the residuals of one model over all frame pairs."""

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import AffinityParams
from moseg.tasks.affinity.ork import ork_affinity
from moseg.tasks.affinity.residual import residual_affinity


def estimate_affinity(residuals: np.ndarray, params: AffinityParams, energy: np.ndarray | None = None) -> np.ndarray:
    """Return the affinity of each two objects by the method that the parameters name.

    Parameters
    ----------
    residuals : float64 (M, K, K)
        [pair, model object, data object], px²; NaN if unknown. Object 0 is the background.
    params : AffinityParams
    energy : float64 (M, K), optional
        Mean squared flow length of each object, px² (``flow_energy``), for residuals of flow models.

    Returns
    -------
    float64 (K, K)
        Symmetric. NaN, not 0, for two objects never visible together: the clustering fills in such values.

    Raises
    ------
    InputError
        If the residuals are not (M, K, K) or the energies not (M, K).
    """
    if residuals.ndim != 3 or residuals.shape[1] != residuals.shape[2]:
        raise InputError("wrong shape of residuals", where="affinity", got=residuals.shape, expected="(M, K, K)")
    if energy is not None and energy.shape != residuals.shape[:2]:
        raise InputError("wrong shape of energies", where="affinity", got=energy.shape, expected=residuals.shape[:2])
    if params.method == "ork":
        return ork_affinity(residuals, params)
    return residual_affinity(residuals, params, energy)
