"""Evidence of tracks over frame pairs, and its agreement among neighbours that move alike."""

import numpy as np
import pytest

from moseg.schemas.parameters import TrackFieldParams
from moseg.tasks.track_objects import PairEvidence, couple_tracks, mean_field, track_evidence

PARAMS = TrackFieldParams()
CAR = ((100, 60), 5, (-3.0, 0.0), 2.0)


def _evidence(errors):
    """Return evidence whose raw and median errors are `errors` (pair, track)."""
    errors = np.asarray(errors, np.float16)
    return PairEvidence(errors, errors, np.zeros_like(errors), errors, np.zeros_like(errors))


def test_large_errors_are_evidence_of_motion_and_small_ones_against_it(drive):
    scene = drive(CAR)
    found = track_evidence(scene.evidence, PARAMS)
    assert (found[scene.truth == 1] > 1).all()
    assert (found[scene.truth == 0] < -0.5).all()


def test_a_track_that_no_pair_sees_gives_no_evidence():
    assert track_evidence(_evidence([[np.nan, 3.0], [np.nan, np.nan]]), PARAMS)[0] == 0
    assert track_evidence(_evidence(np.zeros((0, 2))), PARAMS).tolist() == [0, 0]


def test_more_pairs_add_evidence_up_to_a_number_of_them():
    counts = [1, 4, PARAMS.max_pairs, PARAMS.max_pairs + 5]
    one, four, most, more = (track_evidence(_evidence([[2.0]] * count), PARAMS)[0] for count in counts)
    assert four == pytest.approx(2 * one)
    assert more == pytest.approx(most)


def test_a_single_huge_error_counts_no_more_than_the_largest_one():
    largest, huge = (track_evidence(_evidence([[0.0], [error]]), PARAMS)[0] for error in (PARAMS.max_error, np.inf))
    assert huge == largest


def test_only_tracks_that_move_alike_are_coupled(drive):
    scene = drive(CAR)
    coupling = couple_tracks(scene.points, scene.visible, PARAMS).tocoo()
    strong = coupling.data > 0.2
    assert strong.sum() > 4 * len(scene.points)
    assert (scene.truth[coupling.row[strong]] == scene.truth[coupling.col[strong]]).all()
    assert coupling.data.max() <= 1


@pytest.mark.parametrize("num_frames", [1, 2, 3])
def test_short_videos_couple_what_they_can(drive, num_frames):
    scene = drive(CAR, num_frames=num_frames)
    coupling = couple_tracks(scene.points, scene.visible, PARAMS)
    assert coupling.shape == (len(scene.points),) * 2
    assert (coupling.nnz > 0) == (num_frames > 1)


def test_hidden_places_are_not_read(drive):
    scene = drive(CAR)
    visible, points = scene.visible.copy(), scene.points.copy()
    visible[::3, 4:] = False
    expected = couple_tracks(points, visible, PARAMS)
    points[~visible] = np.nan
    found = couple_tracks(points, visible, PARAMS)
    assert abs(found - expected).nnz == 0


def test_neighbours_outvote_a_lone_error_but_not_that_of_a_whole_object(drive):
    scene = drive(CAR)
    evidence = track_evidence(scene.evidence, PARAMS)
    slip = 0
    evidence[slip] = 1.0
    state = mean_field(evidence, couple_tracks(scene.points, scene.visible, PARAMS), PARAMS)
    assert state[slip] < 0
    assert ((state > 0) == (scene.truth == 1)).all()


def test_a_weak_track_of_an_object_joins_it(drive):
    scene = drive(CAR)
    evidence = track_evidence(scene.evidence, PARAMS)
    weak = np.flatnonzero(scene.truth == 1)[12]
    evidence[weak] = -0.5
    assert mean_field(evidence, couple_tracks(scene.points, scene.visible, PARAMS), PARAMS)[weak] > 0
