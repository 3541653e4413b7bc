"""Evidence that a track moves, over all frame pairs, and its agreement with the neighbours that move alike."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix

from moseg.schemas.parameters import TrackFieldParams
from moseg.tasks.track_objects.neighbours import near_pairs


class PairEvidence(NamedTuple):
    """Errors of the tracks against the rigid scene, in every frame pair; NaN where a track is not seen in both frames.

    Attributes
    ----------
    error : floating (pair, track)
        In units of the tolerance.
    median_error : floating (pair, track)
        Median over the track and its neighbours that move alike, in units of the tolerance.
    test : floating (pair, track)
        How much worse the best rigid position explains the track's patch than the tracked one, -1..3; 0 where it was
        not tested.
    """

    error: np.ndarray
    median_error: np.ndarray
    test: np.ndarray


def track_evidence(evidence: PairEvidence, params: TrackFieldParams) -> np.ndarray:
    """Return how much rather each track moves than not: half the mean of its raw and its median evidence.

    Parameters
    ----------
    evidence : PairEvidence
    params : TrackFieldParams

    Returns
    -------
    float64 (track,)
        About a log-odds ratio; 0 for a track that no frame pair sees.
    """
    num_pairs = (~np.isnan(evidence.error)).sum(axis=0)
    weight = np.sqrt(np.minimum(num_pairs, params.max_pairs))
    total = np.zeros(len(num_pairs))
    for error, static in (
        (evidence.error, params.static_error),
        (evidence.median_error, params.static_median_error),
    ):
        squared = np.minimum(error.astype(np.float64), params.max_error) ** 2
        mean = np.nansum(squared, axis=0) / np.maximum(num_pairs, 1)
        total += (mean - static) * weight / 2
    return np.where(num_pairs > 0, total / 2, 0)


def couple_tracks(points: np.ndarray, visible: np.ndarray, params: TrackFieldParams) -> csr_matrix:
    """Return the coupling of each track to the tracks that are near it and move alike.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    params : TrackFieldParams

    Returns
    -------
    csr_matrix (track, track) of float64
        Row: track, column: neighbour; at most 1 summed over a neighbour's frames, `num_neighbours` over a row.
    """
    num_tracks, num_frames = visible.shape
    tracks = np.arange(num_tracks)
    gap = min(params.gap, num_frames - 1)
    rows, columns, weights = [], [], []
    num_seen = np.zeros(num_tracks)
    # In the last frames, motions from the past are compared.
    for frame in range(num_frames if gap else 0):
        other = frame + gap if frame + gap < num_frames else frame - gap
        if other < 0:
            continue
        near = near_pairs(points, visible, tracks, (frame, other), params.num_neighbours)
        if near is None:
            continue
        width = params.tolerance + params.relative_tolerance * near.speed0
        weights.append(np.exp(-((near.distance / params.distance) ** 2) - (near.difference / width) ** 2))
        rows.append(near.track0)
        columns.append(near.track1)
        num_seen[near.seen] += 1
    if not rows:
        return csr_matrix((num_tracks, num_tracks))
    places = np.concatenate(rows), np.concatenate(columns)
    coupling = np.concatenate(weights) / num_seen[places[0]]
    return csr_matrix((coupling, places), (num_tracks, num_tracks))


def mean_field(evidence: np.ndarray, coupling: csr_matrix, params: TrackFieldParams) -> np.ndarray:
    """Return the states of a binary field of tracks that agree with their neighbours, by damped mean-field updates.

    Parameters
    ----------
    evidence : float64 (track,)
        Of `track_evidence`.
    coupling : csr_matrix (track, track)
        Of `couple_tracks`.
    params : TrackFieldParams

    Returns
    -------
    float64 (track,)
        Log-odds ratios; tracks above 0 move.
    """
    state = evidence.copy()
    for _ in range(params.num_rounds):
        state = (state + evidence + params.coupling * (coupling @ np.tanh(state / 2))) / 2
    return state
