import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.tasks.tracks import assign_tracks
from moseg.tasks.tracks.labels_at import labels_at


@pytest.fixture
def halves():
    """Four masks: object 2 on the right half."""
    masks = np.zeros((4, 10, 20), np.uint16)
    masks[:, :, 10:] = 2
    return masks


def along(*x):
    return np.stack([np.asarray(x, np.float32), np.full(len(x), 5, np.float32)], axis=-1)[None]


def test_the_object_of_most_visible_frames_wins(halves):
    points = along(3, 12, 13, 14)
    assert assign_tracks(points, np.ones((1, 4), bool), halves) == [2]
    assert assign_tracks(points, np.array([[True, True, False, False]]), halves) == [0]


def test_frames_without_a_mask_do_not_vote(halves):
    assert assign_tracks(along(3, 12, 13, 14), np.ones((1, 4), bool), halves[:1]) == [0]


def test_positions_are_rounded_to_the_nearest_pixel(halves):
    assert assign_tracks(along(9.4, 9.4), np.ones((1, 2), bool), halves[:2]) == [0]
    assert assign_tracks(along(9.5, 9.5), np.ones((1, 2), bool), halves[:2]) == [2]


def test_points_outside_the_frame_do_not_vote(halves):
    assert assign_tracks(along(25, 25, 12), np.ones((1, 3), bool), halves[:3]) == [2]
    np.testing.assert_array_equal(
        labels_at(halves[0], np.array([[-0.6, 0], [-0.5, 0], [19.4, 9.4], [19.5, 0]])), [-1, 0, 2, -1]
    )


def test_tracks_never_seen_are_background(halves):
    result = assign_tracks(along(12, 12, 12, 12), np.zeros((1, 4), bool), halves)
    assert result == [0]
    assert result.dtype == np.uint16


def test_no_tracks(halves):
    assert assign_tracks(np.zeros((0, 4, 2), np.float32), np.zeros((0, 4), bool), halves).shape == (0,)


def test_more_masks_than_frames_are_refused(halves):
    with pytest.raises(InputError, match="got 4; expected at most 2"):
        assign_tracks(along(1, 2), np.ones((1, 2), bool), halves)
