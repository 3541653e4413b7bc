"""Groups of tracks that hang together by a few joins only: two things, and the road or a shadow between them."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix, diags, triu
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from moseg.schemas.parameters import RegroupParams

_FEWEST = 4
"""Tracks of a group that is cut at least."""
_DENSE = 200
"""Tracks up to which all eigenvectors are computed: as fast, and without iterations."""
_TOLERANCE = 1e-6


def cut_thin_joins(
    group: np.ndarray, joined: csr_matrix, motions: Sequence[np.ndarray], params: RegroupParams
) -> np.ndarray:
    """Cut groups of joined tracks in two where few joins hold both sides together and some sample tells them apart.

    Neither suffices alone. Two halves of a lorry with nothing to track between them are joined as thinly as two cars,
    but no sample tells them apart; and single samples part what is one. Sides are cut again.

    How thin a cut is tells its conductance: the summed similarity of the joins that it cuts, as a share of those that
    end in the side with fewer of them. Of all cuts that the second eigenvector of the normalised similarity orders, the
    thinnest is taken. What is in a group though nothing joins it to the rest stays there.

    Parameters
    ----------
    group : int64 (n,)
        Group of each track, from 0; -1 = none.
    joined : csr_matrix (n, n) of float64
        Similarity of joined tracks, as `join_tracks` returns it: only the upper triangle.
    motions : sequence of int64 (n,)
        Motion group of each track in each sample, from 0; -1 = unknown.
    params : RegroupParams

    Returns
    -------
    int64 (n,)
        The side of a cut with most tracks keeps the number of its group; the others have new ones.

    References
    ----------
    J. Shi and J. Malik, Normalized cuts and image segmentation, PAMI 2000; F. Chung, Spectral graph theory, 1997,
    ch. 2 (sweep over the second eigenvector).
    """
    similarity = triu(joined, k=1)
    similarity = (similarity + similarity.T).tocsr()
    found, count = group.copy(), int(group.max(initial=-1)) + 1
    left = [np.flatnonzero(group == number) for number in range(count)]
    while left:
        tracks = left.pop()
        num_pieces, piece = connected_components(similarity[tracks][:, tracks], directed=False)
        for number in range(num_pieces):
            part = tracks[piece == number]
            side = _thinnest_cut(similarity[part][:, part], params) if len(part) >= _FEWEST else None
            if side is None or not _are_told_apart(part[side], part[~side], motions, params):
                continue
            smaller, larger = sorted((part[side], part[~side]), key=len)
            found[smaller] = count
            count += 1
            left += [smaller, larger]
    return found


def _thinnest_cut(similarity: csr_matrix, params: RegroupParams) -> np.ndarray | None:
    """Return one side, bool (n,), of the thinnest cut of a connected graph, or None if it is not thin enough."""
    degree = np.asarray(similarity.sum(axis=1)).ravel()
    order = np.argsort(_second_eigenvector(similarity, degree) / np.sqrt(degree), kind="stable")
    rank = np.empty(len(order), np.intp)
    rank[order] = np.arange(len(order))
    joins = triu(similarity).tocoo()
    first, last = np.sort([rank[joins.row], rank[joins.col]], axis=0)
    # A join is cut from the place of its first track on, until that of its last one.
    opened = np.bincount(first, joins.data, len(order)) - np.bincount(last, joins.data, len(order))
    cut, volume = np.cumsum(opened)[:-1], np.cumsum(degree[order])
    smaller = np.minimum(volume[:-1], volume[-1] - volume[:-1])
    conductance = np.where(smaller >= params.min_side * volume[-1], cut / smaller, np.inf)
    place = int(conductance.argmin())
    return rank <= place if conductance[place] < params.thin_join else None


def _are_told_apart(side0: np.ndarray, side1: np.ndarray, motions: Sequence[np.ndarray], params: RegroupParams) -> bool:
    """Check whether the motion groups of two sides differ in one of the samples."""
    return any(_difference(motion[side0], motion[side1]) >= params.min_difference for motion in motions)


def _difference(motion0: np.ndarray, motion1: np.ndarray) -> float:
    """Return the share of one side's tracks that would have to change their motion groups to have the other's."""
    known0, known1 = motion0[motion0 >= 0], motion1[motion1 >= 0]
    if not len(known0) or not len(known1):
        return 0.0
    count = int(max(known0.max(), known1.max())) + 1
    share0, share1 = (np.bincount(known, minlength=count) / len(known) for known in (known0, known1))
    return float(1 - np.minimum(share0, share1).sum())


def _second_eigenvector(similarity: csr_matrix, degree: np.ndarray) -> np.ndarray:
    """Return the eigenvector of the second largest eigenvalue of the normalised similarity, float64 (n,)."""
    scale = diags(1 / np.sqrt(degree))
    normalised = scale @ similarity @ scale
    first = np.sqrt(degree / degree.sum())
    if len(degree) > _DENSE:
        # Without the first one, which is known; negative eigenvalues do not exceed the second.
        deflated = LinearOperator(
            normalised.shape, lambda vector: normalised @ vector - first * (first @ vector), dtype=np.float64
        )
        start = np.linspace(-1, 1, len(degree))
        try:
            return eigsh(deflated, 1, which="LA", v0=start, tol=_TOLERANCE, rng=np.random.default_rng(0))[1][:, 0]
        except ArpackNoConvergence:
            pass
    return np.linalg.eigh(normalised.toarray() - np.outer(first, first)).eigenvectors[:, -1]
