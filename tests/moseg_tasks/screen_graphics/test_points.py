"""Points in graphics follow the filling, so that tracks end there and pairs are dropped."""

import numpy as np

from moseg.tasks.screen_graphics import end_hidden, pairs_outside

HIDDEN = np.zeros((20, 30), bool)
HIDDEN[5:10, 10:20] = True
OUT, IN = (2.0, 3.0), (14.0, 7.0)


def _tracks(*tracks):
    """Return points and visibility of tracks; None where a track is not visible."""
    points = np.array([[(0, 0) if point is None else point for point in track] for track in tracks], np.float32)
    return points, np.array([[point is not None for point in track] for track in tracks])


def test_a_pair_is_kept_where_it_is_hidden_in_neither_frame():
    first, second = np.array([OUT, IN, OUT, IN]), np.array([OUT, OUT, IN, IN])
    kept0, kept1 = pairs_outside((first + 0.25, second), HIDDEN)
    assert np.array_equal(kept0, [np.add(OUT, 0.25)]) and np.array_equal(kept1, [OUT])


def test_a_point_is_where_its_pixel_is():
    points = np.array([(9.4, 7), (9.6, 7), (19.4, 7), (19.6, 7), (14, 4.4), (14, 4.6), (14, 9.4), (14, 9.6)])
    kept, _ = pairs_outside((points, points), HIDDEN)
    assert np.array_equal(kept, points[[0, 3, 4, 7]])


def test_points_beyond_the_frame_are_as_visible_as_its_border():
    points = np.array([(-4.0, 7.0), (40.0, 7.0), (14.0, -9.0), (14.0, 90.0)])
    assert len(pairs_outside((points, points), HIDDEN)[0]) == len(points)


def test_no_pairs_stay_none():
    none = np.zeros((0, 2))
    assert [each.shape for each in pairs_outside((none, none), HIDDEN)] == [(0, 2), (0, 2)]


def test_a_track_ends_where_it_goes_behind_a_graphic_and_does_not_come_back():
    points, visible = end_hidden(*_tracks([OUT, (5, 4), IN, (25, 7)]), HIDDEN)
    assert visible.tolist() == [[True, True, False, False]]
    assert np.array_equal(points, _tracks([OUT, (5, 4), None, None])[0]) and points.dtype == np.float32


def test_a_track_that_begins_in_a_graphic_is_dropped():
    points, visible = end_hidden(*_tracks([IN, OUT, OUT, OUT], [None, IN, OUT, OUT]), HIDDEN)
    assert points.shape == (0, 4, 2) and visible.shape == (0, 4)


def test_a_track_that_is_seen_in_one_frame_alone_is_dropped():
    _, visible = end_hidden(*_tracks([OUT, IN, IN, IN], [OUT, OUT, IN, IN]), HIDDEN)
    assert visible.tolist() == [[True, True, False, False]]


def test_tracks_outside_stay_as_they_are_also_where_the_corner_of_the_frame_is_hidden():
    """Points that are not visible are zero, and are not in the corner."""
    cornered = HIDDEN.copy()
    cornered[0, 0] = True
    points, visible = _tracks([None, OUT, (3, 3), (4, 3)], [OUT, (3, 3), None, None])
    kept, seen = end_hidden(points, visible, cornered)
    assert np.array_equal(kept, points) and np.array_equal(seen, visible)


def test_what_is_given_is_not_changed():
    points, visible = _tracks([OUT, OUT, IN, OUT])
    before = points.copy(), visible.copy()
    end_hidden(points, visible, HIDDEN)
    assert np.array_equal(points, before[0]) and np.array_equal(visible, before[1])
