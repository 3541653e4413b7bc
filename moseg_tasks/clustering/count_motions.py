"""How many motions there are: the methods by name, for objects as for trajectories."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError
from moseg.schemas.parameters.clustering import TRACK_METHODS, MotionCountParams
from moseg.tasks.clustering.confidences import combined_confidences, confidences
from moseg.tasks.clustering.description_length import description_lengths
from moseg.tasks.clustering.geometric_cost import geometric_costs
from moseg.tasks.clustering.motion_tracks import MotionTracks
from moseg.tasks.clustering.stability import stability_scores


class CountEvidence(NamedTuple):
    """What a number of motions is told from; the K rows are objects or trajectories.

    Attributes
    ----------
    labelings : sequence of int (K,)
        The clusterings into 1, 2, ... motions; one may use fewer labels.
    kernel : float64 (K, K)
        The affinity that was clustered; read by ``confidences``.
    eigenvalues : float64 (V, E)
        Of each view's normalised affinity, descending; read by ``confidences``.
    tracks : sequence of MotionTracks
        Of each section of a video, or of a clip; read by ``geometric`` and ``description_length``.
    resampled : sequence of sequences of int (K,)
        Clusterings as in `labelings` of each of ``resampled_affinities``; read by ``stability``.
    """

    labelings: Sequence[np.ndarray]
    kernel: np.ndarray
    eigenvalues: np.ndarray
    tracks: Sequence[MotionTracks] = ()
    resampled: Sequence[Sequence[np.ndarray]] = ()


class MotionCount(NamedTuple):
    """A number of motions and what it was chosen by.

    Attributes
    ----------
    num_motions : int
        Clusters asked for: the place, from 1, of the chosen labeling.
    scores : float64 (len(labelings),)
        Of 1, 2, ... motions; the largest wins, the first of equals.
    """

    num_motions: int
    scores: np.ndarray


def count_motions(
    evidence: CountEvidence, method: str, params: MotionCountParams, rng: np.random.Generator | None = None
) -> MotionCount:
    """The number of motions by one of the methods that compare clusterings into 1, 2, ... motions.

    Parameters
    ----------
    evidence : CountEvidence
    method : str
        ``description_length``, ``geometric``, ``confidences`` or ``stability``.
    params : MotionCountParams
    rng : numpy.random.Generator, optional
        Draws the minimal samples of fits; read where the method reads tracks.

    Returns
    -------
    MotionCount

    Raises
    ------
    InputError
        Where there is no labeling, the method is unknown, or what it reads is missing.
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
        scores = combined_confidences(rows, params.least_silhouette)
    elif method == "stability":
        if len(evidence.resampled) == 0:
            raise InputError("no resamples to count motions by", where="count_motions: stability")
        scores = stability_scores(evidence.resampled, params.least_agreement)
    else:
        raise InputError("unknown method", where="count_motions", got=method)
    return MotionCount(int(np.argmax(scores)) + 1, scores)


def count_by_eigengap(eigenvalues: np.ndarray, most: int | None = None) -> int:
    """Number of eigenvalues before the largest drop.

    Parameters
    ----------
    eigenvalues : float64 (V, E)
        Of each view's normalised affinity, descending, averaged here over views. A zero follows them where they are
        all, so that K motions of one object each are a possible answer.
    most : int, optional
        Largest answer; None where the eigenvalues are all.

    Returns
    -------
    int
        1 .. K, or `most`.

    References
    ----------
    U. von Luxburg, "A tutorial on spectral clustering", Statistics and Computing 17, 2007, section 8.3.
    """
    mean = eigenvalues.mean(axis=0)
    mean = np.append(mean, 0.0) if most is None or len(mean) <= most else mean[: most + 1]
    return int(np.argmax(-np.diff(mean))) + 1
