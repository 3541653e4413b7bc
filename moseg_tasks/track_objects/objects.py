"""Objects: moving tracks joined where they move alike, and the decision which of them have enough evidence."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components

from moseg.schemas.parameters import TrackObjectParams
from moseg.tasks.track_objects.field import PairEvidence
from moseg.tasks.track_objects.neighbours import near_pairs


class TrackObjects(NamedTuple):
    """Candidates for moving objects, numbered 1.. by falling score, and what decides about them.

    Attributes
    ----------
    object : uint16 (track,)
        Candidate of each track, 0 = background.
    is_moving : bool (object,)
        Whether the evidence suffices to propose it.
    score : float64 (object,)
        `strength` times `test`.
    strength : float64 (object,)
        Sum of the median errors over the tracks and frame pairs, in tolerances.
    test : float64 (object,)
        Mean of the rigidity test over the tracks and frame pairs, -1..3.
    num_tracks, num_observations : int64 (object,)
    """

    object: np.ndarray
    is_moving: np.ndarray
    score: np.ndarray
    strength: np.ndarray
    test: np.ndarray
    num_tracks: np.ndarray
    num_observations: np.ndarray


def find_objects(
    points: np.ndarray, visible: np.ndarray, state: np.ndarray, evidence: PairEvidence, params: TrackObjectParams
) -> TrackObjects:
    """Return the objects of the tracks that move.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    state : float64 (track,)
        Above 0 where a track moves, as `mean_field` returns it.
    evidence : PairEvidence
    params : TrackObjectParams

    Returns
    -------
    TrackObjects
    """
    moving = np.flatnonzero(state > 0)
    count, component = connected_components(_join_tracks(points, visible, moving, params), directed=False)
    num_tracks = np.bincount(component, minlength=count)
    num_observations = np.bincount(component, visible[moving].sum(axis=1), count).astype(np.int64)
    large = np.flatnonzero((num_tracks >= params.min_tracks) & (num_observations >= params.min_observations))
    strength, test = (values[large] for values in _judge(component, moving, count, evidence, params))
    score = strength * test
    order = np.argsort(-score, kind="stable")
    label = np.zeros(count, np.uint16)
    label[large[order]] = np.arange(1, len(large) + 1)
    labels = np.zeros(len(state), np.uint16)
    labels[moving] = label[component]
    return TrackObjects(
        object=labels,
        is_moving=((score >= params.min_score) & (test >= params.min_test))[order],
        score=score[order],
        strength=strength[order],
        test=test[order],
        num_tracks=num_tracks[large[order]],
        num_observations=num_observations[large[order]],
    )


def _join_tracks(points: np.ndarray, visible: np.ndarray, moving: np.ndarray, params: TrackObjectParams) -> csr_matrix:
    """Return the mean similarity of the motions of neighbours among the moving tracks, where it is large enough."""
    place = np.zeros(len(points), np.int64)
    place[moving] = np.arange(len(moving))
    num_frames = visible.shape[1]
    pairs, similarities = [np.zeros((0, 2), np.int64)], [np.zeros(0)]
    for frame in range(num_frames - 1):
        gap = min(params.gap, num_frames - 1 - frame)
        near = near_pairs(points, visible, moving, (frame, frame + gap), params.num_neighbours, params.radius)
        if near is None:
            continue
        width = params.tolerance + params.relative_tolerance * np.maximum(near.speed0, near.speed1)
        width = width + params.spread_tolerance * gap * near.distance
        similarities.append(np.exp(-((near.difference / width) ** 2)))
        pairs.append(np.sort(place[np.stack([near.track0, near.track1], axis=1)], axis=1))
    rows, columns = np.concatenate(pairs).T
    shape = (len(moving), len(moving))
    joined = coo_matrix((np.concatenate(similarities), (rows, columns)), shape).tocsr()
    # Both have the same pattern, because both sum the same entries.
    joined.data /= coo_matrix((np.ones(len(rows)), (rows, columns)), shape).tocsr().data
    joined.data[joined.data < params.min_similarity] = 0
    joined.eliminate_zeros()
    return joined


def _judge(
    component: np.ndarray, moving: np.ndarray, count: int, evidence: PairEvidence, params: TrackObjectParams
) -> tuple[np.ndarray, np.ndarray]:
    """Return the strength and the mean rigidity test of every component, float64 (component,)."""
    error = evidence.median_error[:, moving].astype(np.float64)
    seen = ~np.isnan(error)
    strength = np.where(seen, np.minimum(error, params.max_error), 0).sum(axis=0)
    test = np.where(seen, evidence.test[:, moving], 0).sum(axis=0, dtype=np.float64)
    num_pairs = np.bincount(component, seen.sum(axis=0), count)
    return np.bincount(component, strength, count), np.bincount(component, test, count) / np.maximum(num_pairs, 1)
