"""Regrouping of candidates by motion group: static tracks go, two motions part, parts of one motion join."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from sklearn.metrics import adjusted_rand_score

from moseg.schemas.parameters import CandidateParams, RegroupParams
from moseg.tasks.track_objects.candidates import join_tracks
from moseg.tasks.track_objects.groups import TrackGroups
from moseg.tasks.track_objects.thin_joins import cut_thin_joins

_MIN_SEEN = 2  # tracks of a part in a frame that show where it is


class RegroupedTracks(NamedTuple):
    """Groups of tracks, cut and joined by motion group.

    Attributes
    ----------
    group : int64 (track,)
        From 0; -1 = none.
    is_static : bool (group,)
        Whether the group was cut from a candidate because it moves as the background seems to do.
    """

    group: np.ndarray
    is_static: np.ndarray


def regroup_candidates(
    points: np.ndarray,
    visible: np.ndarray,
    candidate: np.ndarray,
    samples: Sequence[TrackGroups],
    join_params: CandidateParams,
    params: RegroupParams,
) -> RegroupedTracks:
    """Return the groups that the candidates' tracks form, by the motion groups of the most typical sample.

    Now and then a sample joins two movers, or gives one to the background, that others tell apart. The candidates are
    regrouped by each sample, and the result that agrees most with the others is taken: that of the largest mean
    adjusted Rand index. All static tracks count as one group there.

    Motion groups of the sample spread to the candidates' other tracks. The tracks of a candidate that belong to a group
    of static ones are cut from it, in pieces of joined tracks, unless these are most of it: a car that comes along its
    epipolar lines moves as the background does. Its other tracks part by group; parts of one group join if they are
    near in a frame, or if one follows the other in time. Last, moving groups are cut where they are joined thinly and
    some sample tells the sides apart: two vehicles that drive ahead may agree with one motion in most of the samples.

    Parameters
    ----------
    points : floating (track, frame, xy)
        px; read only where `visible`.
    visible : bool (track, frame)
    candidate : uint16 (track,)
        0 = none.
    samples : sequence of TrackGroups
        Of which either all are empty or none is.
    join_params : CandidateParams
        With which the candidates were joined.
    params : RegroupParams

    Returns
    -------
    RegroupedTracks
    """
    tracks = np.flatnonzero(candidate)
    if not any(len(groups.track) for groups in samples):
        objects = np.where(candidate > 0, candidate.astype(np.int64) - 1, -1)
        return RegroupedTracks(objects, np.zeros(int(candidate.max(initial=0)), bool))
    joined = join_tracks(points, visible, tracks, join_params)
    motions = [_spread(joined, tracks, groups, params) for groups in samples]
    each_sample = [
        _regrouped(points, visible, candidate, motion, _static_groups(groups, params), joined, params)
        for motion, groups in zip(motions, samples, strict=True)
    ]
    found = each_sample[_most_typical([moving_group(each)[tracks] for each in each_sample])]
    own = moving_group(found)[tracks]
    return _with_parts(found, tracks, own, cut_thin_joins(own, joined, motions, params))


def moving_group(found: RegroupedTracks) -> np.ndarray:
    """Return the group of each track, int64 (track,), -1 also where it is a static one."""
    return np.where(np.append(found.is_static, True)[found.group], -1, found.group)


def _with_parts(found: RegroupedTracks, tracks: np.ndarray, own: np.ndarray, parted: np.ndarray) -> RegroupedTracks:
    """Return the groups with moving ones, `own` (n,) of `tracks`, parted: those numbered above all of them are new."""
    highest, count = int(own.max(initial=-1)), len(found.is_static)
    is_new = parted > highest
    group = found.group.copy()
    group[tracks[is_new]] = parted[is_new] - highest - 1 + count
    num_new = int(parted.max(initial=-1)) - highest
    return RegroupedTracks(group, np.append(found.is_static, np.zeros(num_new, bool)))


def _most_typical(groupings: Sequence[np.ndarray]) -> int:
    """Return which of several groupings of the same tracks agrees most with the others; the first of equal ones."""
    agreement = np.zeros(len(groupings))
    for first in range(len(groupings)):
        for second in range(first):
            agreement[[first, second]] += adjusted_rand_score(groupings[first], groupings[second])
    return int(agreement.argmax())


def _regrouped(
    points: np.ndarray,
    visible: np.ndarray,
    candidate: np.ndarray,
    motion: np.ndarray,
    is_static: np.ndarray,
    joined: csr_matrix,
    params: RegroupParams,
) -> RegroupedTracks:
    """Return the groups that the candidates' tracks form, by their motion groups (n,) of one sample."""
    tracks = np.flatnonzero(candidate)
    objects = np.full(len(candidate), -1)
    group = np.full(len(candidate), -1)
    group[tracks] = motion
    parts: list[tuple[int, np.ndarray]] = []
    static_pieces: list[np.ndarray] = []
    for number in range(1, int(candidate.max(initial=0)) + 1):
        moving, static = _split(np.flatnonzero(candidate == number), group, is_static, params)
        for moved_as, part in moving:
            near = [at for at, (other, _) in enumerate(parts) if moved_as == other >= 0]
            near = [at for at in near if _belong_together(parts[at][1], part, points, visible, params)]
            part = np.concatenate([part, *(parts[at][1] for at in near)])
            parts = [entry for at, entry in enumerate(parts) if at not in near] + [(moved_as, part)]
        static_pieces += _pieces(static, joined, tracks, params)
    for number, part in enumerate([*(part for _, part in parts), *static_pieces]):
        objects[part] = number
    return RegroupedTracks(objects, np.arange(len(parts) + len(static_pieces)) >= len(parts))


def _static_groups(groups: TrackGroups, params: RegroupParams) -> np.ndarray:
    """Return which motion groups are static ones: mostly of static tracks, or with a large share of all of those."""
    count = int(groups.motion.max()) + 1
    num_static = np.bincount(groups.motion[~groups.is_candidate], minlength=count)
    share = num_static / np.maximum(np.bincount(groups.motion, minlength=count), 1)
    return (share > params.static_majority) | (num_static > params.static_share * num_static.sum())


def _spread(joined: csr_matrix, tracks: np.ndarray, groups: TrackGroups, params: RegroupParams) -> np.ndarray:
    """Return the motion group of each of `tracks`, int64 (n,), from the sampled ones among them; -1 = unknown."""
    sampled = groups.track[groups.is_candidate]
    rows = np.searchsorted(tracks, sampled)
    given = np.zeros((len(tracks), int(groups.motion.max()) + 1))
    given[rows, groups.motion[groups.is_candidate]] = 1
    joined = joined + joined.T
    degree = np.maximum(np.asarray(joined.sum(axis=1)).ravel(), 1e-9)
    votes = given.copy()
    for _ in range(params.spread_rounds):
        votes = (joined @ votes) / degree[:, None]
        votes[rows] += params.spread_hold * (given[rows] - votes[rows])
    return np.where(votes.max(axis=1) > 0, votes.argmax(axis=1), -1)


def _split(
    part: np.ndarray, group: np.ndarray, is_static: np.ndarray, params: RegroupParams
) -> tuple[list[tuple[int, np.ndarray]], np.ndarray]:
    """Return the moving parts of a candidate by motion group, and its static tracks.

    A candidate that stays whole is one part, with group -1.
    """
    own = group[part]
    known = own[own >= 0]
    moving = known[~is_static[known]]
    if len(known) - len(moving) >= params.keep_whole * len(known):
        return [(-1, part)], part[:0]
    main = np.bincount(moving).argmax()
    own = np.where(own < 0, main, own)
    found = [(int(motion), part[own == motion]) for motion in np.unique(moving)]
    return [(motion, tracks) for motion, tracks in found if len(tracks) >= params.min_part], part[is_static[own]]


def _pieces(part: np.ndarray, joined: csr_matrix, tracks: np.ndarray, params: RegroupParams) -> list[np.ndarray]:
    """Return the pieces of a part, among `tracks`, whose tracks are joined."""
    rows = np.searchsorted(tracks, part)
    count, piece = connected_components(joined[rows][:, rows], directed=False)
    found = [part[piece == number] for number in range(count)]
    return [tracks for tracks in found if len(tracks) >= params.min_part]


def _belong_together(
    part0: np.ndarray, part1: np.ndarray, points: np.ndarray, visible: np.ndarray, params: RegroupParams
) -> bool:
    """Check whether two parts are near each other in a frame, or one goes on where the other ends."""
    for frame in np.flatnonzero(visible[part0].any(axis=0) & visible[part1].any(axis=0)):
        place0, place1 = (points[part[visible[part, frame]], frame] for part in (part0, part1))
        if cKDTree(place0).query(place1)[0].min() < params.near:
            return True
    frames0, frames1 = (np.flatnonzero(visible[part].sum(axis=0) >= _MIN_SEEN) for part in (part0, part1))
    if not len(frames0) or not len(frames1):
        return False
    if frames0[0] > frames1[0]:
        part0, part1, frames0, frames1 = part1, part0, frames1, frames0
    return _goes_on(part0, frames0[-1], part1, frames1[0], points, visible, params)


def _goes_on(
    part0: np.ndarray,
    last: int,
    part1: np.ndarray,
    first: int,
    points: np.ndarray,
    visible: np.ndarray,
    params: RegroupParams,
) -> bool:
    """Check whether most of `part1` in its `first` frame lies where `part0`, in its `last` frame, is going to be."""
    gap = int(first) - int(last)
    if not 0 <= gap <= params.max_gap:
        return False
    seen = part0[visible[part0, last]]
    place, speed = points[seen, last].astype(np.float64), np.zeros(2)
    before = visible[seen, last - 1] if last else np.zeros(len(seen), bool)
    if before.any():
        speed = np.median(place[before] - points[seen[before], last - 1], axis=0)
    margin = params.margin + params.margin_per_frame * gap
    lower, upper = place.min(axis=0) + speed * gap - margin, place.max(axis=0) + speed * gap + margin
    there = points[part1[visible[part1, first]], first]
    return bool(((there >= lower) & (there <= upper)).all(axis=1).mean() > 0.5)
