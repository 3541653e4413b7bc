"""Candidates cut and joined by motion group."""

import numpy as np
import pytest

from moseg.schemas.parameters import CandidateParams, RegroupParams
from moseg.tasks.track_objects import TrackGroups, moving_group, regroup_candidates

JOIN = CandidateParams()
PARAMS = RegroupParams()
CAR = ((100, 60), 5, (-3.0, 0.0), 2.0)
VAN = ((150, 60), 5, (4.0, 1.0), 2.0)
STATIC, FIRST, SECOND = range(3)


def _sample(scene, motions, every=3):
    """Return groups of each `every`-th track, by the motion of its block; blocks from 1 on are of candidates."""
    tracks = np.arange(0, len(scene.truth), every)
    truth = scene.truth[tracks]
    return TrackGroups(tracks.astype(np.int32), truth > 0, np.array(motions, np.uint16)[truth])


def _regroup_all(scene, candidate, groups, **changes):
    params = PARAMS.model_copy(update=changes)
    return regroup_candidates(scene.points, scene.visible, candidate.astype(np.uint16), [groups], JOIN, params)


def _regroup(scene, candidate, groups, **changes):
    """Return the group of each track, -1 also where it is static."""
    return moving_group(_regroup_all(scene, candidate, groups, **changes))


def _blocks(scene, found):
    """Return the object that each block's tracks belong to, or None where they belong to several."""
    objects = [np.unique(found[scene.truth == label]) for label in range(scene.truth.max() + 1)]
    return [int(values[0]) if len(values) == 1 else None for values in objects]


def test_two_motions_in_a_candidate_are_two_objects(drive):
    scene = drive(CAR, VAN)
    found = _regroup(scene, scene.truth > 0, _sample(scene, (STATIC, FIRST, SECOND)))
    assert found.dtype == np.int64
    assert _blocks(scene, found) == [-1, 0, 1]


def test_groups_spread_along_joined_tracks(drive):
    scene = drive(CAR, VAN)
    groups = _sample(scene, (STATIC, FIRST, SECOND), every=7)
    assert groups.is_candidate.sum() < 10
    assert _blocks(scene, _regroup(scene, scene.truth > 0, groups)) == [-1, 0, 1]
    # Tracks that no group reaches stay with most of the moving ones.
    unspread = _regroup(scene, scene.truth > 0, groups, spread_rounds=0)
    assert (np.bincount(unspread[scene.truth > 0]) != 25).all()


def test_a_wrongly_grouped_track_is_outvoted_by_its_neighbours(drive):
    scene = drive(CAR, VAN)
    groups = _sample(scene, (STATIC, FIRST, SECOND), every=1)
    motion = groups.motion.copy()
    motion[np.flatnonzero(scene.truth == 1)[12]] = SECOND
    wrong = groups._replace(motion=motion)
    assert _blocks(scene, _regroup(scene, scene.truth > 0, wrong, spread_hold=0.1)) == [-1, 0, 1]
    assert _blocks(scene, _regroup(scene, scene.truth > 0, wrong, spread_hold=1.0)) == [-1, None, 1]


def test_static_tracks_leave_a_candidate(drive):
    kerb = ((50, 60), 5, (1.0, 0.0), 2.0)
    scene = drive(CAR, kerb)
    found = _regroup(scene, scene.truth > 0, _sample(scene, (STATIC, FIRST, STATIC)))
    assert _blocks(scene, found) == [-1, 0, -1]


def test_static_tracks_form_a_group_of_each_piece(drive):
    near, far = ((50, 60), 4, (1.0, 0.0), 2.0), ((240, 60), 3, (1.0, 0.0), 2.0)
    scene = drive(CAR, near, far)
    groups = _sample(scene, (STATIC, FIRST, STATIC, STATIC), every=1)
    found = _regroup_all(scene, scene.truth > 0, groups)
    assert found.group.dtype == np.int64
    assert found.is_static.tolist() == [False, True, True]
    assert _blocks(scene, found.group) == [-1, 0, 1, 2]
    # A piece needs as many tracks as any other part.
    few = _regroup_all(scene, scene.truth > 0, groups, min_part=10)
    assert few.is_static.tolist() == [False, True]
    assert _blocks(scene, few.group) == [-1, 0, 1, -1]
    # What stays whole is not static, and without groups nothing is.
    whole = _regroup_all(scene, scene.truth, _sample(scene, (STATIC, STATIC, FIRST, FIRST)))
    assert whole.is_static.tolist() == [False, False, False]
    nothing = TrackGroups(np.zeros(0, np.int32), np.zeros(0, bool), np.zeros(0, np.uint16))
    assert _regroup_all(scene, scene.truth, nothing).is_static.tolist() == [False, False, False]


def test_a_group_with_many_of_the_static_tracks_is_static_too(drive):
    scene = drive(CAR, VAN)
    groups = _sample(scene, (STATIC, FIRST, SECOND))
    # The second motion takes some static tracks along: fewer than its own, but many of all there are.
    static = np.flatnonzero(~groups.is_candidate)
    kept = np.sort(np.concatenate([static[:16], np.flatnonzero(groups.is_candidate)]))
    groups = TrackGroups(*(values[kept] for values in groups))
    motion = groups.motion.copy()
    motion[np.flatnonzero(~groups.is_candidate)[:6]] = SECOND
    taken = groups._replace(motion=motion)
    assert _blocks(scene, _regroup(scene, scene.truth > 0, taken, static_share=0.3)) == [-1, 0, -1]
    assert _blocks(scene, _regroup(scene, scene.truth > 0, taken, static_share=0.4)) == [-1, 0, 1]


def test_a_mover_that_moves_as_the_background_does_is_kept_whole(drive):
    scene = drive(CAR)
    groups = _sample(scene, (STATIC, STATIC))
    assert _blocks(scene, _regroup(scene, scene.truth > 0, groups)) == [-1, 0]
    # Two parts that fell to the static group are not joined for that.
    pair = drive(CAR, ((150, 60), 5, (-3.0, 0.0), 2.0))
    found = _regroup(pair, pair.truth, _sample(pair, (STATIC, STATIC, STATIC)))
    assert _blocks(pair, found) == [-1, 0, 1]


@pytest.mark.parametrize(("keep_whole", "expected"), [(0.4, [-1, 0, 0]), (0.6, [-1, 0, -1])])
def test_a_candidate_stays_whole_from_a_share_of_static_tracks_on(drive, keep_whole, expected):
    kerb = ((50, 60), 5, (1.0, 0.0), 2.0)
    scene = drive(CAR, kerb)
    found = _regroup(scene, scene.truth > 0, _sample(scene, (STATIC, FIRST, STATIC)), keep_whole=keep_whole)
    assert _blocks(scene, found) == expected


def test_a_part_of_few_tracks_is_dropped(drive):
    scene = drive(CAR, ((150, 60), 2, (4.0, 1.0), 2.0))
    groups = _sample(scene, (STATIC, FIRST, SECOND), every=1)
    assert _blocks(scene, _regroup(scene, scene.truth > 0, groups, min_part=4)) == [-1, 0, 1]
    assert _blocks(scene, _regroup(scene, scene.truth > 0, groups, min_part=5)) == [-1, 0, -1]


@pytest.mark.parametrize(
    ("corner", "motion", "expected"),
    [
        ((190, 60), FIRST, [-1, 0, 0]),  # 50 px to the right
        ((190, 60), SECOND, [-1, 0, 1]),
        ((220, 60), FIRST, [-1, 0, 1]),
    ],
)
def test_parts_of_one_group_join_when_they_are_near(drive, corner, motion, expected):
    scene = drive(CAR, (corner, 5, (-3.0, 0.0), 2.0))
    assert _blocks(scene, _regroup(scene, scene.truth, _sample(scene, (STATIC, FIRST, motion)))) == expected


def test_parts_near_in_one_frame_alone_are_joined(drive):
    # The gap closes from 80 to 52 px.
    scene = drive(CAR, ((220, 60), 5, (-7.0, 0.0), 2.0))
    assert _blocks(scene, _regroup(scene, scene.truth, _sample(scene, (STATIC, FIRST, FIRST)))) == [-1, 0, 0]


def test_a_part_between_two_others_joins_them(drive):
    cars = [((corner, 60), 4, (-3.0, 0.0), 2.0) for corner in (50, 250, 150)]
    scene = drive(*cars)
    found = _regroup(scene, scene.truth, _sample(scene, (STATIC, *[FIRST] * 3)), near=80.0)
    assert _blocks(scene, found) == [-1, 0, 0, 0]


@pytest.mark.parametrize("is_swapped", [False, True])
@pytest.mark.parametrize(
    ("first", "shift", "expected"),
    [
        (5, 0, [-1, 0, 0]),
        (5, 40, [-1, 0, 1]),  # beside the place at which it is expected
        (10, 0, [-1, 0, 1]),  # too late
    ],
)
def test_a_part_that_goes_on_where_another_ends_is_joined(drive, first, shift, expected, is_swapped):
    step = np.array([-30.0, 0.0])
    scene = drive(CAR, ((150, 60), 5, tuple(step), 2.0), num_frames=14)
    points, visible = scene.points.copy(), scene.visible.copy()
    car, later = (np.flatnonzero(scene.truth == label) for label in (1, 2))
    # Fast, so that only the expected place is near: both move alike, one until frame 2, the other from `first` on.
    moved = np.array([250.0, 60.0]) + points[car, :1] - points[car[0], 0] + step * np.arange(14)[:, None]
    points[car], points[later] = moved, moved + np.array([0.0, shift])
    visible[car, 3:] = False
    visible[later, :first] = False
    scene = scene._replace(points=points, visible=visible)
    candidate = np.array([0, 2, 1] if is_swapped else [0, 1, 2])[scene.truth]
    found = _regroup(scene, candidate, _sample(scene, (STATIC, FIRST, FIRST)))
    assert sorted(_blocks(scene, found)) == sorted(expected)


def test_the_most_typical_sample_decides(drive):
    scene = drive(CAR, VAN)
    candidate = (scene.truth > 0).astype(np.uint16)
    motions = {"right": (STATIC, FIRST, SECOND), "joined": (STATIC, FIRST, FIRST), "lost": (STATIC, FIRST, STATIC)}
    expected = {"right": [-1, 0, 1], "joined": [-1, 0, 0], "lost": [-1, 0, -1]}
    for names, typical in (
        (("joined", "right", "lost", "right"), "right"),
        (("joined", "lost", "right", "joined"), "joined"),
        (("lost", "joined", "lost"), "lost"),
        (("right", "joined"), "right"),  # the first of two
    ):
        samples = [_sample(scene, motions[name], every) for every, name in enumerate(names, start=2)]
        found = regroup_candidates(scene.points, scene.visible, candidate, samples, JOIN, PARAMS)
        assert _blocks(scene, moving_group(found)) == expected[typical]


def test_static_groups_of_samples_agree_however_many_pieces_they_have(drive):
    near, far = ((50, 60), 4, (1.0, 0.0), 2.0), ((240, 60), 4, (1.0, 0.0), 2.0)
    scene = drive(CAR, near, far)
    samples = [
        _sample(scene, (STATIC, FIRST, *rest)) for rest in ((SECOND, STATIC), (STATIC, STATIC), (STATIC, STATIC))
    ]
    found = regroup_candidates(scene.points, scene.visible, (scene.truth > 0).astype(np.uint16), samples, JOIN, PARAMS)
    assert found.is_static.tolist() == [False, True, True]


def test_without_groups_candidates_stay_as_they_are(drive):
    scene = drive(CAR, VAN)
    nothing = TrackGroups(np.zeros(0, np.int32), np.zeros(0, bool), np.zeros(0, np.uint16))
    assert _blocks(scene, _regroup(scene, scene.truth, nothing)) == [-1, 0, 1]


@pytest.mark.parametrize("num_tracks", [0, 600])
def test_without_candidates_there_is_no_object(drive, num_tracks):
    scene = drive()
    nothing = np.zeros(num_tracks, int)
    tracks = np.arange(0, num_tracks, 2, dtype=np.int32)
    static = TrackGroups(tracks, np.zeros(len(tracks), bool), np.zeros(len(tracks), np.uint16))
    few = scene._replace(points=scene.points[:num_tracks], visible=scene.visible[:num_tracks])
    assert _regroup(few, nothing, static).tolist() == [-1] * num_tracks


def test_a_thin_join_is_cut_where_another_sample_tells_the_sides_apart(drive):
    # Two blocks that meet at a corner and move alike.
    scene = drive(CAR, ((150, 110), 5, (-3.0, 0.0), 2.0))
    joined, parted = _sample(scene, (STATIC, FIRST, FIRST)), _sample(scene, (STATIC, FIRST, SECOND))
    candidate = (scene.truth > 0).astype(np.uint16)

    def regroup(samples, thin_join):
        params = PARAMS.model_copy(update={"thin_join": thin_join})
        return regroup_candidates(scene.points, scene.visible, candidate, samples, JOIN, params)

    most_typical = [joined, joined, joined, parted]
    assert _blocks(scene, moving_group(regroup(most_typical, 0.0))) == [-1, 0, 0]
    found = regroup(most_typical, 0.1)
    assert sorted(_blocks(scene, moving_group(found))) == [-1, 0, 1]
    assert found.is_static.tolist() == [False, False]
    assert _blocks(scene, moving_group(regroup([joined] * 4, 0.1))) == [-1, 0, 0]


def test_new_parts_are_numbered_after_static_groups(drive):
    kerb = ((20, 20), 3, (1.0, 0.0), 2.0)
    scene = drive(CAR, ((150, 110), 5, (-3.0, 0.0), 2.0), kerb)
    alike = _sample(scene, (STATIC, FIRST, FIRST, STATIC), every=1)
    apart = _sample(scene, (STATIC, FIRST, SECOND, STATIC), every=1)
    candidate = (scene.truth > 0).astype(np.uint16)
    params = PARAMS.model_copy(update={"thin_join": 0.1})
    samples = [alike, alike, alike, apart]
    found = regroup_candidates(scene.points, scene.visible, candidate, samples, JOIN, params)
    assert found.is_static.tolist() == [False, True, False]
    background, car, other, bank = _blocks(scene, found.group)
    assert (background, bank) == (-1, 1)
    assert {car, other} == {0, 2}
