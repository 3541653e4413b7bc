"""Score of a group of tracks: how much evidence there is that it moves."""

from typing import NamedTuple

import numpy as np

PAIRS_PER_FRAME = 1.7
"""Frame pairs in a frame of the windows with which smallest scores were chosen: 34 pairs, 2 and 4 frames apart, in 20
frames."""


class GroupScores(NamedTuple):
    """Evidence of G groups of tracks, from group 0.

    Attributes
    ----------
    score : float64 (G,)
        `strength` times `test`, per frame: divided by the number of frame pairs, of which `PAIRS_PER_FRAME` are a
        frame. Short windows have fewer pairs in a frame, and so has another choice of pairs.
    strength : float64 (G,)
        Sum of the median errors over the tracks and frame pairs, in tolerances.
    test : float64 (G,)
        Mean of the rigidity test over the tracks and frame pairs, -1..3.
    num_tracks, num_observations : int64 (G,)
        Tracks, and frames in which they are visible, summed.
    """

    score: np.ndarray
    strength: np.ndarray
    test: np.ndarray
    num_tracks: np.ndarray
    num_observations: np.ndarray


def score_groups(
    group: np.ndarray,
    num_groups: int,
    visible: np.ndarray,
    errors: np.ndarray,
    tests: np.ndarray,
    max_error: float,
) -> GroupScores:
    """Score groups of tracks.

    Parameters
    ----------
    group : integer (track,)
        -1 = none.
    num_groups : int
    visible : bool (track, frame)
    errors, tests : floating (pair, track)
        Median errors and rigidity tests, strict or not; NaN where a track is not seen.
    max_error : float
        Median error in a frame pair, in tolerances, beyond which it adds nothing.

    Returns
    -------
    GroupScores
        0 where a group has no track, or no frame pair sees its tracks.
    """
    tracks = np.flatnonzero(group >= 0)
    group = group[tracks]
    error = errors[:, tracks].astype(np.float64)
    seen = np.isfinite(error)
    strength = np.where(seen, np.minimum(error, max_error), 0).sum(axis=0)
    test = np.where(seen, tests[:, tracks], 0).sum(axis=0, dtype=np.float64)

    def total(values):
        return np.bincount(group, values, num_groups)

    strength, test = total(strength), total(test) / np.maximum(total(seen.sum(axis=0)), 1)
    return GroupScores(
        score=strength * test * PAIRS_PER_FRAME / max(len(errors), 1),
        strength=strength,
        test=test,
        num_tracks=np.bincount(group, minlength=num_groups),
        num_observations=total(visible[tracks].sum(axis=1)).astype(np.int64),
    )
