"""Spectral embeddings of affinities, alone or co-regularised over views."""

from typing import NamedTuple

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, eigsh

FEW_ROWS, FEW_EIGENVALUES = 200, 20
"""For more rows than the first, only as many leading eigenvalues as the second are kept."""
_DENSE = 200
"""Side of a matrix below which computing all eigenvectors is faster than iterating for a few."""
_TOLERANCE = 1e-8


class Embedding(NamedTuple):
    """Spectral embedding of K objects or trajectories.

    Attributes
    ----------
    coordinates : float64 (K, V k)
        The views' k leading eigenvectors side by side, rows scaled to unit length.
    eigenvalues : float64 (V, E)
        Eigenvalues of each view's normalised affinity before co-regularisation, descending; the leading 20 of more than
        200 rows.
    objective : float64 (iterations,)
        The co-regularised objective after each round of updates; it never falls.
    """

    coordinates: np.ndarray
    eigenvalues: np.ndarray
    objective: np.ndarray


def embed_views(
    views: np.ndarray,
    dimension: int,
    co_regularisation: float = 0.0,
    num_iterations: int = 1,
    tolerance: float = 0.0,
) -> Embedding:
    """Return the co-regularised spectral embedding, pairwise form; for one view the spectral embedding.

    Maximises ``sum_v tr(U_v' L_v U_v) + lambda sum_{v<w} tr(U_v U_v' U_w U_w')`` over orthonormal U_v (K, k), one view
    at a time: U_v becomes the k leading eigenvectors of ``L_v + lambda sum_{w != v} U_w U_w'``.

    L_v is the affinity normalised by its degrees on both sides, D^-1/2 A D^-1/2, as Kumar et al. define it and as Xu et
    al. compute it, whose fusion the paper adapts. The paper describes row normalisation, D^-1 A. For one view both give
    the same embedding: the eigenvalues are equal, and eigenvectors V with V'DV = I differ by a factor per row, which
    the scaling to unit rows removes. For several views they differ: the objective requires orthonormal U_v, and only
    the symmetric form has orthonormal eigenvectors.

    Parameters
    ----------
    views : float64 (V, K, K)
        Non-negative symmetric affinities.
    dimension : int
        k.
    co_regularisation : float
        lambda. This and the following parameters are read for two views or more.
    num_iterations : int
        Largest number of rounds.
    tolerance : float
        Relative growth of the objective at which the rounds stop.

    References
    ----------
    A. Kumar, P. Rai and H. Daume III, "Co-regularized multi-view spectral clustering", NIPS 2011, equations 2 to 4.
    X. Xu, L. F. Cheong and Z. Li, "Motion segmentation by exploiting complementary geometric models", CVPR 2018.
    """
    laplacians = [normalise_affinity(view) for view in views]
    num_eigenvalues = len(views[0]) if len(views[0]) <= FEW_ROWS else FEW_EIGENVALUES
    eigenvalues = np.stack([leading_eigenpairs(laplacian, num_eigenvalues)[0] for laplacian in laplacians])
    bases = [leading_eigenpairs(laplacian, dimension)[1] for laplacian in laplacians]
    history = []
    if len(views) > 1 and co_regularisation > 0:
        for _ in range(num_iterations):
            for v, laplacian in enumerate(laplacians):
                others = sum(basis @ basis.T for w, basis in enumerate(bases) if w != v)
                bases[v] = leading_eigenpairs(laplacian + co_regularisation * others, dimension)[1]
            history.append(_objective(laplacians, bases, co_regularisation))
            if len(history) > 1 and history[-1] - history[-2] <= tolerance * abs(history[-1]):
                break
    else:
        history.append(_objective(laplacians, bases, co_regularisation))
    return Embedding(unit_rows(np.concatenate(bases, axis=1)), eigenvalues, np.array(history))


def normalise_affinity(affinity: np.ndarray) -> np.ndarray:
    """Return ``D^-1/2 A D^-1/2`` with D the row sums; rows of zeros stay zero."""
    degree = affinity.sum(axis=1)
    scale = np.where(degree > 0, 1.0 / np.sqrt(np.where(degree > 0, degree, 1.0)), 0.0)
    return scale[:, None] * affinity * scale[None, :]


def unit_rows(vectors: np.ndarray) -> np.ndarray:
    """Scale rows to unit length; rows of zeros stay zero."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return vectors / np.where(length > 0, length, 1.0)


def leading_eigenpairs(symmetric: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the largest eigenvalues of a symmetric matrix and their vectors.

    Parameters
    ----------
    symmetric : float64 (N, N)
    count : int
        At most N.

    Returns
    -------
    eigenvalues : float64 (count,)
        Descending.
    vectors : float64 (N, count)
        Orthonormal, with signs that do not depend on the solver.
    """
    num = len(symmetric)
    if not symmetric.any():
        return np.zeros(count), np.eye(num, count)
    if num < _DENSE or count > num // 4:
        values, vectors = np.linalg.eigh(symmetric)
    else:
        # The default start vector is random, and so are the restarts of an exhausted Krylov space.
        start, rng = np.full(num, num**-0.5), np.random.default_rng(0)
        try:
            values, vectors = eigsh(symmetric, count, which="LA", v0=start, tol=_TOLERANCE, rng=rng)
        except ArpackNoConvergence:
            # Many equal eigenvalues, as those of trajectories that agree on everything.
            values, vectors = np.linalg.eigh(symmetric)
    order = np.argsort(-values, kind="stable")[:count]
    vectors = vectors[:, order]
    largest = vectors[np.argmax(np.abs(vectors), axis=0), np.arange(vectors.shape[1])]
    return values[order], vectors * np.where(largest < 0, -1.0, 1.0)


def _objective(laplacians, bases, co_regularisation) -> float:
    """Return the objective of `embed_views`."""
    own = sum(np.sum(basis * (laplacian @ basis)) for laplacian, basis in zip(laplacians, bases, strict=True))
    num = len(bases)
    shared = sum(np.sum((bases[v].T @ bases[w]) ** 2) for v in range(num) for w in range(v + 1, num))
    return float(own + co_regularisation * shared)
