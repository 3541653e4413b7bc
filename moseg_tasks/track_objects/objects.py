"""Objects: the decision which groups of tracks have enough evidence that they move."""

from typing import NamedTuple

import numpy as np

from moseg.schemas.parameters import TrackObjectParams
from moseg.tasks.track_objects.compactness import enclosed_share
from moseg.tasks.track_objects.field import PairEvidence
from moseg.tasks.track_objects.regroup import RegroupedTracks
from moseg.tasks.track_objects.score import score_groups
from moseg.tasks.track_objects.wholeness import complete_objects, share_of_groups

_LEAST_SCORE = 1e-6
"""Score that a part needs at least, even where `min_score` is 0."""


class TrackObjects(NamedTuple):
    """Objects of tracks, numbered 1.. by falling score, and what decides about them.

    Attributes
    ----------
    object : uint16 (track,)
        0 = background.
    is_moving : bool (object,)
        Whether the evidence suffices.
    score, strength, test : float64 (object,)
    num_tracks, num_observations : int64 (object,)
        See `GroupScores`.
    best_part : float64 (object,)
        Highest score of the object's part in one candidate, in scores that such a part needs.
    on_surface : float64 (object,)
        See `WholeObjects`.
    """

    object: np.ndarray
    is_moving: np.ndarray
    score: np.ndarray
    strength: np.ndarray
    test: np.ndarray
    num_tracks: np.ndarray
    num_observations: np.ndarray
    best_part: np.ndarray
    on_surface: np.ndarray


def judge_objects(
    groups: RegroupedTracks,
    candidate: np.ndarray,
    surface: np.ndarray,
    points: np.ndarray,
    visible: np.ndarray,
    evidence: PairEvidence,
    params: TrackObjectParams,
) -> TrackObjects:
    """Decide which groups of tracks move, by an absolute measure of evidence: in a static scene none does.

    The evidence is that of the groups as given; then each takes the rest of the surfaces of which it has a good part.
    A static group, which its motion group says is background, is an object only if it is compact, and its patches say
    clearly that no rigid position explains them; else its tracks belong to the background.

    Parameters
    ----------
    groups : RegroupedTracks
    candidate : uint16 (track,)
        0 = none. Parts of several candidates with little evidence each are no object, whatever their sum: one of them
        must be nearly enough alone, as what lies on a surface or does not.
    surface : integer (track,)
        0 = none. What lies on no surface needs more evidence: slips of the tracker are scattered.
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    evidence : PairEvidence
    params : TrackObjectParams

    Returns
    -------
    TrackObjects
        Of all groups, whether they move or not, but static ones with too little evidence.
    """
    strict = evidence.strict_error, evidence.strict_test
    group = _without_static_groups(groups, points, visible, *strict, params)
    count = int(group.max(initial=-1)) + 1
    found = score_groups(group, count, visible, *strict, params.max_error)
    whole = complete_objects(group, surface, params)
    needed = _smallest_scores(whole.on_surface, params)
    best_part = _best_parts(group, count, candidate, whole.is_on_surface, visible, evidence, params)
    large = (found.num_tracks >= params.min_tracks) & (found.num_observations >= params.min_observations)
    relative = params.min_ratio / params.sensitivity * found.score.max(initial=0)
    enough = (found.score >= np.maximum(needed, relative)) & (found.test >= params.min_test / params.sensitivity)
    is_moving = large & enough & (best_part >= params.min_part)
    order = np.argsort(-found.score, kind="stable")
    number = np.zeros(count + 1, np.uint16)
    number[order] = np.arange(1, count + 1)
    return TrackObjects(
        object=number[whole.group],
        is_moving=is_moving[order],
        score=found.score[order],
        strength=found.strength[order],
        test=found.test[order],
        num_tracks=found.num_tracks[order],
        num_observations=found.num_observations[order],
        best_part=best_part[order],
        on_surface=whole.on_surface[order],
    )


def _smallest_scores(on_surface: np.ndarray, params: TrackObjectParams) -> np.ndarray:
    """Return the score that groups of tracks need, by the share of theirs on surfaces, float64 (group,)."""
    scattered = max(params.min_score, params.min_scattered_score)
    return np.where(on_surface < params.min_on_surface, scattered, params.min_score) / params.sensitivity


def _best_parts(
    group: np.ndarray,
    num_groups: int,
    candidate: np.ndarray,
    is_on_surface: np.ndarray,
    visible: np.ndarray,
    evidence: PairEvidence,
    params: TrackObjectParams,
) -> np.ndarray:
    """Return the best score of a group's part in one candidate, in scores that such a part needs, float64 (group,)."""
    stride = int(candidate.max(initial=0)) + 1
    tracks = np.flatnonzero(group >= 0)
    keys, parts = np.unique(group[tracks] * stride + candidate[tracks], return_inverse=True)
    part = np.full(len(group), -1)
    part[tracks] = parts
    strict = evidence.strict_error, evidence.strict_test
    score = score_groups(part, len(keys), visible, *strict, params.max_error).score
    needed = _smallest_scores(share_of_groups(is_on_surface, part, len(keys)), params)
    best = np.full(num_groups, -np.inf)
    np.maximum.at(best, keys // stride, score / np.maximum(needed, _LEAST_SCORE))
    return best


def _without_static_groups(
    groups: RegroupedTracks,
    points: np.ndarray,
    visible: np.ndarray,
    errors: np.ndarray,
    tests: np.ndarray,
    params: TrackObjectParams,
) -> np.ndarray:
    """Return the group of each track, int64 (track,), without the static groups that have too little evidence.

    They must not take the surfaces of others, therefore they go before these are completed.
    """
    found = score_groups(groups.group, len(groups.is_static), visible, errors, tests, params.max_error)
    has_score = found.score >= params.min_score / params.sensitivity
    kept = ~groups.is_static | (has_score & (found.test >= params.min_static_test / params.sensitivity))
    for number in np.flatnonzero(kept & groups.is_static):
        kept[number] = enclosed_share(points, visible, groups.group == number) >= params.min_enclosed
    return np.append(np.where(kept, np.cumsum(kept) - 1, -1), -1)[groups.group]
