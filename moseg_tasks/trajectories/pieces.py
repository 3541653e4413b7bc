"""Pieces of trajectories, and the affinity between them from many hypotheses."""

from functools import lru_cache

import numpy as np
from scipy.cluster.hierarchy import linkage
from scipy.spatial.distance import squareform

from moseg.schemas.parameters import PieceParams
from moseg.tasks.trajectories.hypothesis_residuals import NOT_SEEN, HypothesisResiduals, preferences


def piece_affinity(residual: HypothesisResiduals, pieces: np.ndarray, params: PieceParams) -> np.ndarray:
    """Return the ordered residual kernel between pieces: the share of preferred hypotheses in common.

    In each set of frames a piece prefers the hypotheses of smallest median distance to its trajectories, a share
    `params.window` of all. The residuals of a single trajectory are noisy; the median over a piece on one surface
    orders hypotheses reliably.

    Parameters
    ----------
    residual : HypothesisResiduals
        Of N trajectories.
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
    is_member = chosen >= 0
    seen = residual.is_seen[:, chosen] & is_member
    medians = _lower_medians(residual, chosen, seen)
    count = max(1, round(params.window * residual.num_hypotheses))
    is_seen = seen.sum(axis=2) >= np.minimum(params.min_tracks, is_member.sum(axis=1))
    preferred = preferences(medians, count) & is_seen[..., None]
    flat = np.swapaxes(preferred, 0, 1).reshape(len(chosen), -1).astype(np.float32)
    common = (flat @ flat.T).astype(np.float64) / count
    together = is_seen.T.astype(np.float64) @ is_seen
    mean = common / np.maximum(together, 1)
    root = np.sqrt(np.maximum(np.diag(mean), np.finfo(np.float64).tiny))
    affinity = mean / (root[:, None] * root[None, :])
    np.fill_diagonal(affinity, 1.0)
    return affinity**params.power


def link_pieces(affinity: np.ndarray) -> np.ndarray:
    """Group P pieces by average linkage of affinities (P, P) in 0..1: int (P, P), [number of groups - 1, piece].

    Pieces of one group have the same number, which is below 2P.
    """
    if len(affinity) == 1:
        return np.zeros((1, 1), dtype=np.int64)
    distance = 1.0 - (affinity + affinity.T) / 2
    np.fill_diagonal(distance, 0.0)
    groups = [np.arange(len(affinity))]
    links = linkage(squareform(distance, checks=False), "average")[:, :2].astype(np.int64)
    for number, (first, second) in enumerate(links.tolist(), start=len(affinity)):
        last = groups[-1]
        groups.append(np.where((last == first) | (last == second), number, last))
    return np.stack(groups[::-1])


def _members(pieces: np.ndarray, max_tracks: int) -> np.ndarray:
    """Choose up to `max_tracks` evenly spaced trajectories of each piece: int (P, max_tracks), padded by -1."""
    chosen = np.full((int(pieces.max()) + 1, max_tracks), -1)
    for piece, row in enumerate(chosen):
        own = np.flatnonzero(pieces == piece)
        if len(own) > max_tracks:
            own = own[_evenly_spaced(len(own), max_tracks)]
        row[: len(own)] = own
    return chosen


@lru_cache(maxsize=4096)
def _evenly_spaced(length: int, count: int) -> np.ndarray:
    """Return `count` indices below `length`, from the first to the last: int (count,), read-only."""
    indices = np.linspace(0, length - 1, count).round().astype(int)
    indices.flags.writeable = False
    return indices


def _lower_medians(residual: HypothesisResiduals, chosen: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Return the codes uint16 (S, P, H) of each piece's median distances, over its trajectories that a set shows.

    Whole arrays are sorted against each other: a sorting network of a few dozen comparisons takes a tenth of the time
    of as many short sorts.
    """
    num_pieces, num_members = chosen.shape
    codes = residual.of_tracks(np.maximum(chosen.T, 0).ravel())
    codes = codes.reshape(len(codes), num_members, num_pieces, -1)
    codes[:, chosen.T < 0] = NOT_SEEN
    ranks = list(np.moveaxis(codes, 1, 0))
    # Those that are not seen come last.
    middle = np.maximum(seen.sum(axis=2) - 1, 0) // 2
    needed = tuple(np.unique(middle).tolist())
    for low, high in _selection_network(num_members, needed):
        smaller = np.minimum(ranks[low], ranks[high])
        np.maximum(ranks[low], ranks[high], out=ranks[high])
        ranks[low] = smaller
    medians = ranks[needed[0]].copy()
    for rank in needed[1:]:
        own = middle == rank
        medians[own] = ranks[rank][own]
    return medians


@lru_cache(maxsize=256)
def _selection_network(size: int, ranks: tuple[int, ...]) -> tuple[tuple[int, int], ...]:
    """Return those comparisons of the sorting network on which some ranks depend, in order."""
    needed, comparisons = set(ranks), []
    for pair in reversed(_sorting_network(size)):
        if needed.intersection(pair):
            needed.update(pair)
            comparisons.append(pair)
    return tuple(reversed(comparisons))


@lru_cache(maxsize=16)
def _sorting_network(size: int) -> tuple[tuple[int, int], ...]:
    """Return the comparisons of Batcher's merge exchange, in order (Knuth, The Art of Computer Programming, 5.2.2M)."""
    comparisons = []
    half = 1 << max((size - 1).bit_length() - 1, 0)
    outer = half
    while outer:
        step, distance, residue = half, outer, 0
        while True:
            comparisons += [(low, low + distance) for low in range(size - distance) if low & outer == residue]
            if step == outer:
                break
            distance, step, residue = step - outer, step // 2, outer
        outer //= 2
    return tuple(comparisons)
