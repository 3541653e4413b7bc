"""Candidates for moving objects: what is joined, how they are numbered, and which are left out."""

import numpy as np
import pytest

from moseg.schemas.parameters import CandidateParams
from moseg.tasks.track_objects import PairEvidence, find_candidates
from moseg.tasks.track_objects.candidates import join_tracks
from moseg.tasks.track_objects.score import PAIRS_PER_FRAME

PARAMS = CandidateParams()
CAR = ((100, 60), 5, (-3.0, 0.0), 2.0)
VAN = ((150, 60), 5, (4.0, 1.0), 2.0)
CAR_SCORE = 25 * 4 * 2 * PAIRS_PER_FRAME
FAR_CAR = ((200, 120), 5, (-3.0, 0.0), 2.0)


def _find(scene, state=None, **changes):
    state = np.where(scene.truth > 0, 1.0, -1.0) if state is None else state
    return find_candidates(scene.points, scene.visible, state, scene.evidence, PARAMS.model_copy(update=changes))


def _matches(found, truth):
    """Check whether two labellings, both with 0 for the background, are the same but for their numbers."""
    pairs = {*zip(found.tolist(), truth.tolist(), strict=True)}
    return ((found > 0) == (truth > 0)).all() and len(pairs) == truth.max() + 1


@pytest.mark.parametrize("other", [VAN, FAR_CAR])
def test_tracks_of_other_motion_or_far_away_are_another_candidate(drive, other):
    scene = drive(CAR, other)
    found = _find(scene)
    assert found.dtype == np.uint16
    assert _matches(found, scene.truth)
    assert _find(scene, radius=200.0, num_neighbours=30, tolerance=50.0).max() == 1


def test_an_approaching_object_is_one_candidate(drive):
    scene = drive(CAR)
    car = scene.truth == 1
    centre = scene.points[car, :1].mean(axis=0)
    growth = 1 + 0.03 * np.arange(scene.points.shape[1])[:, None]
    points = scene.points.copy()
    points[car] = centre + (scene.points[car, :1] - centre) * growth
    assert _matches(_find(scene._replace(points=points)), scene.truth)


def test_candidates_are_numbered_by_falling_score(drive):
    scene = drive(((100, 60), 4, (-3.0, 0.0), 2.0), ((200, 60), 6, (4.0, 1.0), 2.0))
    found = _find(scene)
    assert (found[scene.truth == 2] == 1).all()
    assert (found[scene.truth == 1] == 2).all()


def test_only_tracks_that_move_are_candidates(drive):
    scene = drive(CAR)
    state = np.where(scene.truth > 0, 1.0, -1.0)
    still = np.flatnonzero(scene.truth)[[0, 7, 12]]
    state[still] = 0
    found = _find(scene, state)
    assert not found[still].any()
    assert (found > 0).sum() == (scene.truth > 0).sum() - len(still)


@pytest.mark.parametrize(
    ("smallest", "too_large"),
    [
        ({"min_tracks": 25}, {"min_tracks": 26}),
        ({"min_observations": 25 * 8}, {"min_observations": 25 * 8 + 1}),
        # 25 tracks with an error of 4 and a test of 2 in each pair.
        ({"min_score": CAR_SCORE - 0.1}, {"min_score": CAR_SCORE + 0.1}),
        ({"min_test": 2.0}, {"min_test": 2.1}),
        ({"min_score": 0.75 * CAR_SCORE - 0.1, "max_error": 3.0}, {"min_score": 0.8 * CAR_SCORE, "max_error": 3.0}),
    ],
)
def test_groups_below_a_threshold_are_no_candidates(drive, smallest, too_large):
    assert _find(drive(CAR), **smallest).max() == 1
    assert not _find(drive(CAR), **too_large).any()


def test_candidates_are_judged_by_one_surface_in_a_patch(drive):
    scene = drive(CAR)
    nothing = np.zeros_like(scene.evidence.error)
    outline = scene._replace(evidence=scene.evidence._replace(strict_error=nothing, strict_test=nothing))
    assert _find(outline).max() == 1
    slipped = scene._replace(evidence=scene.evidence._replace(test=nothing))
    assert not _find(slipped).any()


@pytest.mark.parametrize("num_tracks", [0, 1, 600])
def test_without_moving_tracks_there_is_no_candidate(drive, num_tracks):
    scene = drive()
    evidence = PairEvidence(*(array[:, :num_tracks] for array in scene.evidence))
    parts = (scene.points[:num_tracks], scene.visible[:num_tracks], scene.truth[:num_tracks])
    found = _find(scene._make((*parts, evidence)))
    assert found.tolist() == [0] * num_tracks


@pytest.mark.parametrize("num_frames", [1, 2])
def test_without_frame_pairs_there_is_no_candidate(drive, num_frames):
    assert not _find(drive(CAR, num_frames=num_frames)).any()


def test_the_similarity_of_two_tracks_is_a_mean_over_the_frames_in_which_they_are_near():
    # Side by side, then apart by 1.5 px in the two frames of the gap; afterwards too far to be neighbours.
    own = np.array([0.0, 0, 0, 0, 1.5, 101.5, 201.5, 301.5])
    points = np.zeros((2, 8, 2), np.float32)
    points[1] = np.stack([own, np.full(8, 10.0)], axis=1)
    visible = np.ones((2, 8), bool)
    alike = CandidateParams(gap=1, relative_tolerance=0, spread_tolerance=0, tolerance=1.5, min_similarity=0.01)
    joined = join_tracks(points, visible, np.array([0, 1]), alike)
    similarities = [1, 1, 1, np.exp(-1), 0]
    np.testing.assert_allclose(joined.toarray(), [[0, np.mean(similarities)], [0, 0]], rtol=1e-5)
    assert join_tracks(points, visible, np.array([0, 1]), alike.model_copy(update={"min_similarity": 0.9})).nnz == 0


def test_hidden_places_are_not_read(drive):
    scene = drive(CAR, VAN)
    visible, points = scene.visible.copy(), scene.points.copy()
    visible[::3, 4:] = False
    hidden = scene._replace(visible=visible)
    expected = _find(hidden)
    points[~visible] = np.nan
    np.testing.assert_array_equal(_find(hidden._replace(points=points)), expected)
