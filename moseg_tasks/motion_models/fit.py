"""Least-squares fits of a flow model and the errors of every object under every fit, from moments only."""

import numpy as np

from moseg.schemas.parameters import FlowModelParams
from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.motion_models.moments import unpack_moments


def fit_from_moments(moments: np.ndarray, model: FlowModel, params: FlowModelParams) -> tuple[np.ndarray, np.ndarray]:
    """Return the least-squares parameters of each object; of several solutions the one of smallest norm.

    Parameters
    ----------
    moments : float64 (K, (P + 1)² + 1)
        Of ``flow_moments``.
    model : FlowModel
    params : FlowModelParams

    Returns
    -------
    theta : float64 (K, P)
        Zero if invalid.
    valid : bool (K,)
        False if the object has fewer than ``params.min_pixels`` pixels.
    """
    factor, target, _, count = unpack_moments(moments)
    valid = count >= max(params.min_pixels, model.num_parameters)
    theta = (np.linalg.pinv(factor, rcond=params.rank_tolerance) @ target[..., None])[..., 0]
    return np.where(valid[:, None], theta, 0.0), valid


def residuals_from_moments(moments: np.ndarray, theta: np.ndarray, valid: np.ndarray) -> np.ndarray:
    """Return the mean squared error of each object's flow under each object's parameters.

    Parameters
    ----------
    moments : float64 (K, (P + 1)² + 1)
    theta : float64 (K, P)
    valid : bool (K,)

    Returns
    -------
    float64 (K, K)
        Row: object of the parameters; column: object of the pixels; px² (squared length of the flow difference, mean
        over pixels). NaN if the model is invalid or the object has too few pixels to be valid itself.
    """
    factor, target, rest, count = unpack_moments(moments)
    difference = np.einsum("jqp,ip->ijq", factor, theta) - target
    errors = (difference**2).sum(axis=2) + rest**2
    known = valid[:, None] & valid[None, :]
    return np.where(known, errors / np.maximum(count, 1), np.nan)


def flow_energy(moments: np.ndarray) -> np.ndarray:
    """Return the mean squared flow length of each object, float64 (K,), px²; NaN if it has no pixels."""
    _, target, rest, count = unpack_moments(moments)
    return np.where(count > 0, ((target**2).sum(axis=1) + rest**2) / np.maximum(count, 1), np.nan)
