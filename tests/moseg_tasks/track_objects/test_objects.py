"""Objects of moving tracks: what is joined, and what has enough evidence to be proposed."""

import numpy as np
import pytest

from moseg.schemas.parameters import TrackObjectParams
from moseg.tasks.track_objects import PairEvidence, find_objects

PARAMS = TrackObjectParams()
CAR = ((100, 60), 5, (-3.0, 0.0), 2.0)
VAN = ((150, 60), 5, (4.0, 1.0), 2.0)


def _find(scene, state=None, **changes):
    state = np.where(scene.truth > 0, 1.0, -1.0) if state is None else state
    return find_objects(scene.points, scene.visible, state, scene.evidence, PARAMS.model_copy(update=changes))


def test_tracks_of_different_motions_are_different_objects(drive):
    scene = drive(CAR, VAN)
    found = _find(scene)
    assert found.is_moving.tolist() == [True, True]
    assert ((found.object > 0) == (scene.truth > 0)).all()
    assert len({*zip(found.object.tolist(), scene.truth.tolist(), strict=True)}) == 3


def test_tracks_of_one_motion_far_apart_are_different_objects(drive):
    scene = drive(CAR, ((200, 120), 5, (-3.0, 0.0), 2.0))
    assert len(_find(scene).score) == 2


def test_an_approaching_object_is_one_object(drive):
    scene = drive(CAR)
    car = scene.truth == 1
    centre = scene.points[car, :1].mean(axis=0)
    growth = 1 + 0.03 * np.arange(scene.points.shape[1])[:, None]
    points = scene.points.copy()
    points[car] = centre + (scene.points[car, :1] - centre) * growth
    assert len(_find(scene._replace(points=points)).score) == 1


def test_features_are_those_of_the_tracks_and_pairs(drive):
    scene = drive(CAR)
    found = _find(scene)
    num_tracks, (num_pairs, _) = (scene.truth == 1).sum(), scene.evidence.error.shape
    assert found.num_tracks.tolist() == [num_tracks]
    assert found.num_observations.tolist() == [num_tracks * scene.points.shape[1]]
    assert found.strength.tolist() == [4 * num_tracks * num_pairs]
    assert found.test.tolist() == [2]
    assert found.score.tolist() == [8 * num_tracks * num_pairs]


def test_candidates_are_numbered_by_falling_score(drive):
    scene = drive(((100, 60), 4, (-3.0, 0.0), 2.0), ((200, 60), 6, (4.0, 1.0), 2.0))
    found = _find(scene)
    assert (np.diff(found.score) <= 0).all()
    assert (found.object[scene.truth == 2] == 1).all()


@pytest.mark.parametrize("changes", [{"min_test": 2.5}, {"min_score": 1e6}])
def test_a_candidate_with_too_little_evidence_is_named_but_does_not_move(drive, changes):
    found = _find(drive(CAR), **changes)
    assert found.object.max() == 1
    assert found.is_moving.tolist() == [False]


def test_what_a_rigid_position_explains_as_well_does_not_move(drive):
    assert _find(drive(((100, 60), 5, (-3.0, 0.0), 0.2))).is_moving.tolist() == [False]


@pytest.mark.parametrize("changes", [{"min_tracks": 26}, {"min_observations": 10_000}])
def test_small_groups_are_no_candidates(drive, changes):
    found = _find(drive(CAR), **changes)
    assert len(found.score) == 0
    assert not found.object.any()


@pytest.mark.parametrize("num_tracks", [0, 1, 600])
def test_without_moving_tracks_there_is_no_object(drive, num_tracks):
    scene = drive()
    few = scene._replace(points=scene.points[:num_tracks], visible=scene.visible[:num_tracks])
    few = few._replace(
        truth=scene.truth[:num_tracks], evidence=PairEvidence(*(a[:, :num_tracks] for a in scene.evidence))
    )
    found = _find(few)
    assert (len(found.object), len(found.score)) == (num_tracks, 0)
    assert found.object.dtype == np.uint16


def test_without_frame_pairs_nothing_moves(drive):
    scene = drive(CAR, num_frames=2)
    assert not _find(scene).is_moving.any()
