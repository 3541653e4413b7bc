"""Pieces of trajectories, and the affinity between them from many hypotheses."""

import numpy as np
from scipy.cluster.hierarchy import cut_tree, linkage
from scipy.spatial.distance import squareform

from moseg.schemas.parameters import PieceParams


def piece_affinity(residual: np.ndarray, pieces: np.ndarray, params: PieceParams) -> np.ndarray:
    """Return the ordered residual kernel between pieces: the share of preferred hypotheses in common.

    In each set of frames a piece prefers the hypotheses of smallest median distance to its trajectories, a share
    `params.window` of all. The residuals of a single trajectory are noisy; the median over a piece on one surface
    orders hypotheses reliably.

    Parameters
    ----------
    residual : float16 (S, H, N)
        px, [set of frames, hypothesis, trajectory]; NaN if a trajectory is not visible.
    pieces : int (N,)
        0 .. P - 1, each in use.
    params : PieceParams

    Returns
    -------
    affinity : float64 (P, P)
        0..1, symmetric, 1 on the diagonal, raised to `params.power`: the mean over the sets that show both pieces,
        divided by the geometric mean of both diagonals; 0 if there is no such set.
    """
    chosen = _members(pieces, params.num_tracks)
    num_pieces, num_hypotheses = len(chosen), residual.shape[1]
    members = residual[:, :, chosen.ravel()].astype(np.float32).reshape(len(residual), num_hypotheses, *chosen.shape)
    members[:, :, chosen < 0] = np.nan
    members.sort(axis=-1)
    # NaN is sorted last, and is the same for all hypotheses of a set.
    num_seen = np.count_nonzero(np.isfinite(members[:, 0]), axis=-1)
    middle = np.maximum(num_seen - 1, 0) // 2
    median = np.take_along_axis(members, middle[:, None, :, None], axis=-1)[..., 0]

    count = max(1, round(params.window * num_hypotheses))
    is_seen = num_seen >= np.minimum(params.min_tracks, np.count_nonzero(chosen >= 0, axis=1))
    nearest = np.argpartition(median, min(count, num_hypotheses - 1), axis=1)[:, :count]
    preferred = np.zeros_like(median)
    np.put_along_axis(preferred, nearest, 1.0, axis=1)
    preferred *= is_seen[:, None, :]
    flat = preferred.reshape(-1, num_pieces).astype(np.float64)
    common = flat.T @ flat / count
    together = is_seen.T.astype(np.float64) @ is_seen
    mean = common / np.maximum(together, 1)
    root = np.sqrt(np.maximum(np.diag(mean), np.finfo(np.float64).tiny))
    affinity = mean / (root[:, None] * root[None, :])
    np.fill_diagonal(affinity, 1.0)
    return affinity**params.power


def link_pieces(affinity: np.ndarray) -> np.ndarray:
    """Group P pieces by average linkage of affinities (P, P) in 0..1: int (P, P), [number of groups - 1, piece]."""
    if len(affinity) == 1:
        return np.zeros((1, 1), dtype=np.int64)
    distance = 1.0 - (affinity + affinity.T) / 2
    np.fill_diagonal(distance, 0.0)
    return cut_tree(linkage(squareform(distance, checks=False), "average")).T[::-1]


def _members(pieces: np.ndarray, max_tracks: int) -> np.ndarray:
    """Choose up to `max_tracks` evenly spaced trajectories of each piece: int (P, max_tracks), padded by -1."""
    chosen = np.full((int(pieces.max()) + 1, max_tracks), -1)
    for piece, row in enumerate(chosen):
        own = np.flatnonzero(pieces == piece)
        if len(own) > max_tracks:
            own = own[np.linspace(0, len(own) - 1, max_tracks).round().astype(int)]
        row[: len(own)] = own
    return chosen
