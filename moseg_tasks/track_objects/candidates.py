"""Candidates for moving objects: moving tracks that are joined because they are near and move alike."""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from moseg.schemas.parameters import CandidateParams
from moseg.tasks.track_objects.field import PairEvidence
from moseg.tasks.track_objects.neighbours import near_pairs
from moseg.tasks.track_objects.score import score_groups


def find_candidates(
    points: np.ndarray, visible: np.ndarray, state: np.ndarray, evidence: PairEvidence, params: CandidateParams
) -> np.ndarray:
    """Return the candidate that each track belongs to.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    state : floating (track,)
        Above 0 where a track moves, as `mean_field` returns it.
    evidence : PairEvidence
    params : CandidateParams

    Returns
    -------
    uint16 (track,)
        1.. by falling score; 0 = none.
    """
    moving = np.flatnonzero(state > 0)
    count, component = connected_components(join_tracks(points, visible, moving, params), directed=False)
    group = np.full(len(state), -1)
    group[moving] = component
    found = score_groups(group, count, visible, evidence.median_error, evidence.test, params.max_error)
    large = (found.num_tracks >= params.min_tracks) & (found.num_observations >= params.min_observations)
    kept = np.flatnonzero(large & (found.score >= params.min_score) & (found.test >= params.min_test))
    number = np.zeros(count + 1, np.uint16)
    number[kept[np.argsort(-found.score[kept], kind="stable")]] = np.arange(1, len(kept) + 1)
    return number[group]


def join_tracks(points: np.ndarray, visible: np.ndarray, tracks: np.ndarray, params: CandidateParams) -> csr_matrix:
    """Return the mean similarity of the motions of neighbours among `tracks`, where it is large enough.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    tracks : int64 (n,)
        Ascending.
    params : CandidateParams

    Returns
    -------
    csr_matrix (n, n) of float64
        In the order of `tracks`; only the upper triangle.
    """
    place = np.zeros(len(points), np.int64)
    place[tracks] = np.arange(len(tracks))
    num_frames = visible.shape[1]
    pairs, similarities = [np.zeros((0, 2), np.int64)], [np.zeros(0)]
    for frame in range(num_frames - 1):
        gap = min(params.gap, num_frames - 1 - frame)
        near = near_pairs(points, visible, tracks, (frame, frame + gap), params.num_neighbours, params.radius)
        if near is None:
            continue
        width = params.tolerance + params.relative_tolerance * np.maximum(near.speed0, near.speed1)
        width = width + params.spread_tolerance * gap * near.distance
        similarities.append(np.exp(-((near.difference / width) ** 2)))
        pairs.append(np.sort(place[np.stack([near.track0, near.track1], axis=1)], axis=1))
    rows, columns = np.concatenate(pairs).T
    shape = (len(tracks), len(tracks))
    joined = coo_matrix((np.concatenate(similarities), (rows, columns)), shape).tocsr()
    # Both have the same pattern, because both sum the same entries.
    joined.data /= coo_matrix((np.ones(len(rows)), (rows, columns)), shape).tocsr().data
    joined.data[joined.data < params.min_similarity] = 0
    joined.eliminate_zeros()
    return joined
