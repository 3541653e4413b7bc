"""Reduction of sums over monomials to the triangular factor of a model's least-squares problem."""

import numpy as np

from moseg.tasks.motion_models.flow_model import FlowModel
from moseg.tasks.motion_models.monomials import Frame, recentring

_GRAM_RANK = 1e-14  # eigenvalue of a Gram matrix of unit columns below which it is rounding


def local_columns(frame: Frame, depth_gauge: tuple[float, float], model: FlowModel) -> np.ndarray:
    """Return the model's terms on an object's local monomials, u and v: float64 (2, 9, P).

    `depth_gauge` is the (shift, scale) that is subtracted from the model's inverse depth and divides it.
    """
    shift, scale = depth_gauge
    plane = {name: getattr(frame, name) / scale for name in ("rho_x", "rho_y", "rho_scale")}
    centred = recentring(frame._replace(rho0=(frame.rho0 - shift) / scale, **plane))
    return np.stack([centred @ model.u_terms, centred @ model.v_terms])


def reduce_to_model(
    gram: np.ndarray, cross: np.ndarray, columns: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return triangular factors R (K, P, P), targets t (K, P) and the energy that the targets explain (K,).

    The Gram matrix of the well-conditioned local monomials is factored by its eigenvectors, without undetermined
    directions; the model's columns, which may be nearly dependent, are then reduced by Householder QR.

    Parameters
    ----------
    gram : float64 (K, 9, 9)
    cross : float64 (K, 9, 2)
        Products of the monomials with u and v.
    columns : float64 (K, 2, 9, P)
    """
    sizes = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    sizes = np.where(sizes > 0, sizes, 1.0)
    values, vectors = np.linalg.eigh(gram / (sizes[:, :, None] * sizes[:, None, :]))
    known = values > _GRAM_RANK
    roots = np.sqrt(np.where(known, values, 0.0))
    root = roots[:, :, None] * vectors.transpose(0, 2, 1) * sizes[:, None, :]
    inverse = np.where(known, 1.0 / np.where(known, roots, 1.0), 0.0)
    data = inverse[:, :, None] * (vectors.transpose(0, 2, 1) @ (cross / sizes[:, :, None]))
    num = len(gram)
    stacked = (root[:, None] @ columns).reshape(num, -1, columns.shape[-1])
    q, r = np.linalg.qr(stacked)
    target = (q.transpose(0, 2, 1) @ data.transpose(0, 2, 1).reshape(num, -1, 1))[..., 0]
    return r, target, (target**2).sum(axis=1)
