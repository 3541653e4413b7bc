"""The number of motions of objects or trajectories, by method name."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.clustering import TRACK_METHODS, MotionCountParams
from moseg.tasks.clustering.confidences import combine_confidences, confidences
from moseg.tasks.clustering.description_length import description_lengths
from moseg.tasks.clustering.geometric_cost import geometric_costs
from moseg.tasks.clustering.motion_tracks import MotionTracks
from moseg.tasks.clustering.stability import stability_scores


class CountEvidence(NamedTuple):
    """Data from which a number of motions is found; the K rows are objects or trajectories.

    Attributes
    ----------
    labelings : sequence of int (K,)
        The clusterings into 1, 2, ... motions; one may use fewer labels.
    kernel : float64 (K, K)
        The clustered affinity; read by ``confidences``.
    eigenvalues : float64 (V, E)
        Eigenvalues of each view's normalised affinity, descending; read by ``confidences``.
    tracks : sequence of MotionTracks
        Tracks of each section of a video, or of a clip; read by ``geometric`` and ``description_length``.
    resampled : sequence of sequences of int (K,)
        Clusterings as in `labelings` of each of ``resampled_affinities``; read by ``stability``.
    """

    labelings: Sequence[np.ndarray]
    kernel: np.ndarray
    eigenvalues: np.ndarray
    tracks: Sequence[MotionTracks] = ()
    resampled: Sequence[Sequence[np.ndarray]] = ()


class MotionCount(NamedTuple):
    """A number of motions and the scores of all numbers.

    Attributes
    ----------
    num_motions : int
        Number of clusters: the position, from 1, of the chosen labeling.
    scores : float64 (len(labelings),)
        Scores of 1, 2, ... motions; the largest wins, the first of equals.
    """

    num_motions: int
    scores: np.ndarray


def count_motions(
    evidence: CountEvidence, method: str, params: MotionCountParams, rng: np.random.Generator | None = None
) -> MotionCount:
    """Find the number of motions by one of the methods that compare clusterings into 1, 2, ... motions.

    Parameters
    ----------
    evidence : CountEvidence
    method : str
        ``description_length``, ``geometric``, ``confidences`` or ``stability``.
    params : MotionCountParams
    rng : numpy.random.Generator, optional
        Draws the minimal samples of fits; read by methods that read tracks.

    Returns
    -------
    MotionCount

    Raises
    ------
    InputError
        If there is no labeling, the method is unknown, or its data are missing.
    """
    if len(evidence.labelings) == 0:
        raise InputError("no clustering to count", where="count_motions", got="0 labelings", expected="one or more")
    if method in TRACK_METHODS:
        if rng is None or len(evidence.tracks) == 0:
            raise InputError("no tracks to count motions by", where=f"count_motions: {method}", expected="tracks, rng")
        measure = description_lengths if method == "description_length" else geometric_costs
        scores = -measure(evidence.labelings, evidence.tracks, params, rng)
    elif method == "confidences":
        rows = confidences(evidence.labelings, evidence.kernel, evidence.eigenvalues)
        scores = combine_confidences(rows, params.least_silhouette)
    elif method == "stability":
        if len(evidence.resampled) == 0:
            raise InputError("no resamples to count motions by", where="count_motions: stability")
        scores = stability_scores(evidence.resampled, params.least_agreement)
    else:
        raise InputError("unknown method", where="count_motions", got=method)
    return MotionCount(int(np.argmax(scores)) + 1, scores)


def count_by_eigengap(eigenvalues: np.ndarray, max_count: int | None = None) -> int:
    """Return the number of eigenvalues before the largest gap.

    Parameters
    ----------
    eigenvalues : float64 (V, E)
        Eigenvalues of each view's normalised affinity, descending, averaged here over views. If they are all, a zero
        is appended, so that K motions of one object each are a possible result.
    max_count : int, optional
        Largest result; None if the eigenvalues are all.

    Returns
    -------
    int
        1 .. K, or `max_count`.

    References
    ----------
    U. von Luxburg, "A tutorial on spectral clustering", Statistics and Computing 17, 2007, section 8.3.
    """
    mean = eigenvalues.mean(axis=0)
    mean = np.append(mean, 0.0) if max_count is None or len(mean) <= max_count else mean[: max_count + 1]
    return int(np.argmax(-np.diff(mean))) + 1
