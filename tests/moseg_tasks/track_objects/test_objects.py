"""The decision which groups of tracks move, and what it rests on."""

import numpy as np
import pytest

from moseg.schemas.parameters import TrackObjectParams
from moseg.tasks.track_objects import PairEvidence, RegroupedTracks, judge_objects
from moseg.tasks.track_objects.compactness import enclosed_share
from moseg.tasks.track_objects.score import PAIRS_PER_FRAME

PARAMS = TrackObjectParams()
CAR = ((100, 60), 5, (-3.0, 0.0), 2.0)
VAN = ((150, 60), 4, (4.0, 1.0), 2.0)
CAR_SCORE = 25 * 4 * 2 * PAIRS_PER_FRAME
"""25 tracks with an error of 4 and a test of 2 in each pair."""


def _judge(scene, group=None, candidate=None, surface=None, static=(), **changes):
    """Judge the blocks of a scene, each of which is one group, candidate and surface where these are not given.

    `static` are the groups that are said to be background.
    """
    group = scene.truth - 1 if group is None else group
    candidate = (group + 1).astype(np.uint16) if candidate is None else candidate
    surface = scene.truth.astype(np.uint16) if surface is None else surface
    groups = RegroupedTracks(group, np.isin(np.arange(group.max(initial=-1) + 1), static))
    params = PARAMS.model_copy(update=changes)
    return judge_objects(groups, candidate, surface, scene.points, scene.visible, scene.evidence, params)


def test_features_are_those_of_the_tracks_and_pairs(drive):
    found = _judge(drive(CAR))
    assert found.num_tracks.tolist() == [25]
    assert found.num_observations.tolist() == [25 * 8]
    assert found.strength.tolist() == [4 * 25 * 6]
    assert found.test.tolist() == [2]
    assert found.score.tolist() == pytest.approx([CAR_SCORE])
    assert found.best_part.tolist() == pytest.approx([CAR_SCORE / PARAMS.min_score])
    assert found.on_surface.tolist() == [1]
    assert found.is_moving.tolist() == [True]


@pytest.mark.parametrize("num_frames", [8, 64])
def test_a_score_is_the_same_in_a_longer_window(drive, num_frames):
    """Of which more frames have a pair."""
    assert _judge(drive(CAR, num_frames=num_frames)).score[0] == pytest.approx(CAR_SCORE)


def test_errors_count_up_to_the_largest_one(drive):
    assert _judge(drive(CAR), max_error=2.0).score.tolist() == pytest.approx([CAR_SCORE / 2])


def test_pairs_that_do_not_see_a_track_add_nothing(drive):
    scene = drive(CAR)
    values = [array.copy() for array in scene.evidence]
    for array in values:
        array[::2] = np.nan
    found = _judge(scene._replace(evidence=PairEvidence(*values)))
    assert found.score.tolist() == pytest.approx([CAR_SCORE / 2])
    assert found.test.tolist() == [2]


def test_objects_are_numbered_by_falling_score_whether_they_move_or_not(drive):
    scene = drive(VAN, CAR, ((10, 10), 2, (3.0, 3.0), 2.0))
    found = _judge(scene)
    assert found.object.dtype == np.uint16
    assert (np.diff(found.score) < 0).all()
    assert [np.unique(found.object[scene.truth == label]).tolist() for label in range(4)] == [[0], [2], [1], [3]]
    # Four tracks are too few.
    assert found.is_moving.tolist() == [True, True, False]


@pytest.mark.parametrize(
    ("enough", "too_little"),
    [
        ({"min_tracks": 25}, {"min_tracks": 26}),
        ({"min_observations": 200}, {"min_observations": 201}),
        ({"min_score": CAR_SCORE}, {"min_score": CAR_SCORE + 0.1}),
        ({"min_test": 2.0}, {"min_test": 2.1}),
    ],
)
def test_an_object_with_too_little_evidence_is_named_but_does_not_move(drive, enough, too_little):
    for changes, moves in ((enough, True), (too_little, False)):
        found = _judge(drive(CAR), **changes)
        assert found.object.max() == 1
        assert found.is_moving.tolist() == [moves]


@pytest.mark.parametrize("name", ["min_score", "min_test"])
def test_sensitivity_divides_the_smallest_score_and_test(drive, name):
    value = {"min_score": CAR_SCORE, "min_test": 2.0}[name] * 3
    moves = [_judge(drive(CAR), **{name: value}, sensitivity=times).is_moving[0] for times in (1.0, 2.9, 3.0, 5.0)]
    assert moves == [False, False, True, True]


def test_a_low_sensitivity_asks_for_more(drive):
    assert _judge(drive(CAR), sensitivity=1.0).is_moving[0]
    assert not _judge(drive(CAR), sensitivity=0.9 * PARAMS.min_test / 2).is_moving[0]
    assert not _judge(drive(CAR), min_score=CAR_SCORE, sensitivity=0.9).is_moving[0]


def test_an_object_needs_a_share_of_the_best_ones_evidence(drive):
    scene = drive(CAR, VAN)
    share = _judge(scene).score[1] / _judge(scene).score[0]
    moves = [_judge(scene, min_ratio=share * factor).is_moving.tolist() for factor in (0.99, 1.01)]
    assert moves == [[True, True], [True, False]]
    assert _judge(scene, min_ratio=share * 1.01, sensitivity=1.1).is_moving.tolist() == [True, True]


def test_objects_are_judged_by_two_surfaces_in_a_patch(drive):
    scene = drive(CAR)
    nothing, errors, tests = np.zeros_like(scene.evidence.error), scene.evidence.error, scene.evidence.test
    corners = PairEvidence(errors, errors, tests, nothing, nothing)
    found = _judge(scene._replace(evidence=corners))
    assert found.score.tolist() == found.test.tolist() == [0]
    assert not found.is_moving.any()
    mover = PairEvidence(nothing, nothing, nothing, errors, tests)
    assert _judge(scene._replace(evidence=mover)).score.tolist() == [CAR_SCORE]


def test_weak_parts_of_different_candidates_do_not_add_up_to_an_object(drive):
    scene = drive(CAR)
    car = np.flatnonzero(scene.truth)
    candidate = np.zeros(len(scene.truth), np.uint16)
    candidate[car] = 1 + np.arange(len(car)) % 5
    limit = {"min_score": CAR_SCORE, "min_part": 0.3}
    # Five parts with a fifth of the score each.
    parted = _judge(scene, candidate=candidate, **limit)
    assert parted.score.tolist() == [CAR_SCORE]
    assert parted.best_part.tolist() == [1 / 5]
    assert parted.is_moving.tolist() == [False]
    assert _judge(scene, **limit).is_moving.tolist() == [True]
    assert _judge(scene, candidate=candidate, min_score=CAR_SCORE, min_part=0.2).is_moving.tolist() == [True]
    # The smallest score of a part is divided by the sensitivity too.
    assert _judge(scene, candidate=candidate, **limit, sensitivity=2.0).is_moving.tolist() == [True]


def test_the_best_part_is_that_of_the_object_itself(drive):
    scene = drive(CAR, VAN)
    found = _judge(scene, candidate=(scene.truth > 0).astype(np.uint16))
    np.testing.assert_array_equal(found.best_part, found.score / PARAMS.min_score)


def test_a_scattered_part_does_not_move_with_a_surface_that_it_joins(drive):
    # The car's tracks show that it moves and lie on no surface; the van's, of its motion group, lie on one.
    scene = drive(CAR, (*VAN[:3], 0.0))
    group = np.where(scene.truth > 0, 0, -1)
    surface = np.where(scene.truth == 2, 1, 0).astype(np.uint16)
    candidate = scene.truth.astype(np.uint16)
    limits = {"min_score": CAR_SCORE / 5, "min_scattered_score": 1.5 * CAR_SCORE, "min_test": 0.0}
    joined = _judge(scene, group, candidate, surface, **limits)
    assert joined.on_surface[0] > PARAMS.min_on_surface
    assert joined.best_part.tolist() == [pytest.approx(1 / 1.5)]
    assert joined.is_moving.tolist() == [False]
    # Nor with a surface of its own of which it has a small part: the car's and the background's.
    of_all = np.where(surface == 1, 1, 2).astype(np.uint16)
    assert _judge(scene, group, candidate, of_all, **limits).is_moving.tolist() == [False]
    # One candidate is one part, whatever its tracks lie on; nor is a part scattered that lies on a surface.
    assert _judge(scene, group, (candidate > 0).astype(np.uint16), surface, **limits).is_moving.tolist() == [True]
    assert _judge(scene, group, candidate, (candidate > 0).astype(np.uint16), **limits).is_moving.tolist() == [True]


def test_with_a_smallest_score_of_zero_any_evidence_is_enough(drive):
    limits = {"min_score": 0.0, "min_scattered_score": 0.0, "min_test": 0.0}
    found = _judge(drive((*CAR[:3], 1e-4)), **limits)
    assert np.isfinite(found.best_part).all()
    assert found.is_moving.tolist() == [True]
    assert _judge(drive((*CAR[:3], 0.0)), **limits).is_moving.tolist() == [False]


@pytest.mark.parametrize("num_tracks", [0, 1, 600])
def test_without_groups_there_is_no_object(drive, num_tracks):
    scene = drive()
    evidence = PairEvidence(*(array[:, :num_tracks] for array in scene.evidence))
    group, nothing = np.full(num_tracks, -1), np.zeros(num_tracks, np.uint16)
    for surface in (nothing, nothing + 1):
        groups = RegroupedTracks(group, np.zeros(0, bool))
        tracks = scene.points[:num_tracks], scene.visible[:num_tracks]
        found = judge_objects(groups, nothing, surface, *tracks, evidence, PARAMS)
        assert found.object.tolist() == [0] * num_tracks
        assert {len(values) for values in found[1:]} == {0}


def test_without_frame_pairs_nothing_moves(drive):
    assert _judge(drive(CAR, num_frames=2)).is_moving.tolist() == [False]


def _parted(scene, num_seen):
    """Return groups in which only the first tracks of the car show that it moves."""
    group = np.full(len(scene.truth), -1)
    group[np.flatnonzero(scene.truth == 1)[:num_seen]] = 0
    return group


def test_an_object_takes_the_rest_of_its_surface_but_not_its_evidence(drive):
    scene = drive(CAR)
    found = _judge(scene, _parted(scene, 10))
    np.testing.assert_array_equal(found.object, scene.truth)
    assert found.num_tracks.tolist() == [10]
    assert found.score.tolist() == [CAR_SCORE * 10 / 25]
    assert found.on_surface.tolist() == [1]
    alone = _judge(scene, _parted(scene, 10), min_surface=0.5)
    np.testing.assert_array_equal(alone.object, _parted(scene, 10) + 1)
    assert alone.on_surface.tolist() == [0]


def test_objects_keep_their_numbers_with_the_rest_of_their_surfaces(drive):
    scene = drive(VAN, CAR)
    found = _judge(scene, np.where(_parted(scene, 5) == 0, 0, np.where(scene.truth == 2, 1, -1)))
    assert (np.diff(found.score) < 0).all()
    assert [np.unique(found.object[scene.truth == label]).tolist() for label in range(3)] == [[0], [2], [1]]
    scattered = _judge(scene, surface=np.where(scene.truth == 1, 1, 0).astype(np.uint16))
    assert scattered.on_surface.tolist() == [0, 1]


@pytest.mark.parametrize(("num_on_surface", "needs"), [(0, 12.0), (7, 12.0), (8, 3.0), (25, 3.0)])
def test_a_scattered_object_needs_more_evidence(drive, num_on_surface, needs):
    scene = drive(CAR)
    surface = np.zeros(len(scene.truth), np.uint16)
    surface[np.flatnonzero(scene.truth)[:num_on_surface]] = 1
    for score, moves in ((needs * 0.999, False), (needs * 1.001, True)):
        # The evidence is that of a car with other errors.
        errors = scene.evidence.strict_error.astype(np.float64) * score / CAR_SCORE
        evidence = scene.evidence._replace(strict_error=errors)
        found = _judge(scene._replace(evidence=evidence), surface=surface)
        assert found.score[0] == pytest.approx(score)
        assert found.on_surface.tolist() == [num_on_surface / 25]
        assert found.is_moving.tolist() == [moves], score


@pytest.mark.parametrize(
    ("changes", "moves"),
    [
        ({"min_scattered_score": CAR_SCORE}, True),
        ({"min_scattered_score": CAR_SCORE + 0.1}, False),
        ({"min_scattered_score": CAR_SCORE + 0.1, "sensitivity": 1.1}, True),
        ({"min_scattered_score": CAR_SCORE + 0.1, "min_on_surface": 0.0}, True),
        # It needs no less than other objects do.
        ({"min_scattered_score": 0.0, "min_score": CAR_SCORE + 0.1}, False),
    ],
)
def test_what_a_scattered_object_needs(drive, changes, moves):
    scene = drive(CAR)
    assert _judge(scene, surface=np.zeros(len(scene.truth), np.uint16), **changes).is_moving.tolist() == [moves]


@pytest.mark.parametrize(
    ("kept", "left"),
    [
        ({"min_static_test": 2.0}, {"min_static_test": 2.1}),
        ({"min_score": CAR_SCORE}, {"min_score": CAR_SCORE + 0.1}),
        ({"min_static_test": 4.0, "sensitivity": 2.0}, {"min_static_test": 4.1, "sensitivity": 2.0}),
        ({"min_score": 2 * CAR_SCORE, "sensitivity": 2.0}, {"min_score": 2 * CAR_SCORE + 0.1, "sensitivity": 2.0}),
    ],
)
def test_a_static_group_with_too_little_evidence_is_background(drive, kept, left):
    scene = drive(CAR)
    kept, left = ({"min_enclosed": 0.0} | changes for changes in (kept, left))
    found = _judge(scene, static=(0,), **kept)
    assert found.is_moving.tolist() == [True]
    assert np.unique(found.object[scene.truth == 1]).tolist() == [1]
    none = _judge(scene, static=(0,), **left)
    assert none.is_moving.tolist() == []
    assert none.object.max() == 0


def test_a_static_group_must_fill_its_place(drive):
    scene = drive(CAR)
    # Tracks of the background are seen through the block.
    share = enclosed_share(scene.points, scene.visible, scene.truth == 1)
    assert 0.3 < share < 0.9
    for bound, count in ((share - 0.01, 1), (share + 0.01, 0)):
        assert len(_judge(scene, static=(0,), min_enclosed=bound).is_moving) == count
    # What is not static may lie anywhere.
    assert _judge(scene, min_enclosed=1.0).is_moving.tolist() == [True]


def test_a_static_group_that_goes_takes_no_surface(drive):
    scene = drive(CAR, VAN)
    one = np.ones(len(scene.truth), np.uint16)
    changes = {"surface": one * (scene.truth > 0), "static": (0,), "min_enclosed": 0.0}
    found = _judge(scene, **changes, min_static_test=3.0)
    # The van, which is the smaller part of the surface, has all of it.
    assert np.unique(found.object[scene.truth > 0]).tolist() == [1]
    assert found.num_tracks.tolist() == [16]
    kept = _judge(scene, **changes, min_static_test=2.0)
    assert sorted(kept.num_tracks.tolist()) == [16, 25]
