"""Static candidates: which tracks are those of something that may move and shows too little evidence of it."""

import numpy as np
import pytest

from moseg.tasks.track_objects import static_candidates


def test_surfaces_are_numbered_after_all_objects_and_moving_objects_are_left_out():
    objects, surface = np.array([1, 2, 0, 0, 0, 2], np.uint16), np.array([0, 0, 1, 3, 0, 3], np.uint16)
    labels = static_candidates(objects, np.array([True, False, True]), surface, 16)
    assert labels.dtype == np.uint16
    # A track of an object is that object's, not its surface's.
    assert labels.tolist() == [0, 2, 4, 6, 0, 2]
    assert static_candidates(objects, np.array([True, True, True]), surface, 16).tolist() == [0, 0, 4, 6, 0, 0]


@pytest.mark.parametrize(
    ("most", "expected"), [(0, [0, 0, 0, 0]), (1, [0, 2, 0, 0]), (2, [0, 2, 3, 0]), (9, [0, 2, 3, 4])]
)
def test_no_more_candidates_than_are_asked_for_objects_before_surfaces(most, expected):
    objects, surface = np.array([1, 2, 0, 0], np.uint16), np.array([0, 0, 1, 2], np.uint16)
    assert static_candidates(objects, np.array([True, False]), surface, most).tolist() == expected


def test_surfaces_for_which_there_is_no_number_are_left_out():
    surface = np.array([1, 65534, 65535], np.uint16)
    for is_moving, expected in (([False], [2, 65535, 0]), ([False, True], [3, 0, 0])):
        labels = static_candidates(np.zeros(3, np.uint16), np.array(is_moving), surface, 10**6)
        assert labels.tolist() == expected


def test_without_objects_surfaces_are_numbered_from_one_and_without_tracks_nothing_is():
    none = np.zeros(0, bool)
    assert static_candidates(np.zeros(2, np.uint16), none, np.array([2, 0], np.uint16), 16).tolist() == [2, 0]
    assert static_candidates(np.zeros(0, np.uint16), none, np.zeros(0, np.uint16), 16).tolist() == []
