"""Share of a group's own tracks inside its convex hull."""

import numpy as np

from moseg.tasks.track_objects.compactness import enclosed_share

ROWS, COLUMNS = np.mgrid[0:6, 0:6].reshape(2, -1)
GRID = np.stack([COLUMNS, ROWS], axis=1) * 10.0


def _still(num_frames):
    return np.repeat(GRID[:, None], num_frames, axis=1), np.ones((len(GRID), num_frames), bool)


def test_a_block_fills_its_place():
    points, visible = _still(3)
    assert enclosed_share(points, visible, (ROWS < 3) & (COLUMNS < 4)) == 1


def test_other_tracks_inside_the_hull_and_on_it_count():
    points, visible = _still(3)
    corners = np.isin(ROWS, (0, 2)) & np.isin(COLUMNS, (0, 2))
    assert enclosed_share(points, visible, corners) == 4 / 9


def test_only_tracks_that_are_seen_in_the_frame_count():
    points, visible = _still(3)
    corners = np.isin(ROWS, (0, 2)) & np.isin(COLUMNS, (0, 2))
    visible[(ROWS == 0) & (COLUMNS == 1)] = False
    points[~visible] = np.nan
    assert enclosed_share(points, visible, corners) == 4 / 8
    # Three corners enclose three tracks more, of which one is not seen.
    visible[(ROWS == 2) & (COLUMNS == 2)] = False
    assert enclosed_share(points, visible, corners) == 3 / 5


def test_the_share_is_the_median_over_frames_that_show_three_tracks():
    points, visible = _still(5)
    corners = np.isin(ROWS, (0, 2)) & np.isin(COLUMNS, (0, 2))
    others = (ROWS < 3) & (COLUMNS < 3) & ~corners
    visible[others, :2] = False
    visible[np.flatnonzero(corners)[:2], 3:] = False
    assert enclosed_share(points, visible, corners) == 1
    visible[np.flatnonzero(corners)[:2], 2:] = False
    visible[others, 1] = True
    assert enclosed_share(points, visible, corners) == np.mean([1, 4 / 9])


def test_few_tracks_enclose_nothing():
    points, visible = _still(2)
    assert enclosed_share(points, visible, (ROWS == 0) & (COLUMNS < 2)) == 0
    assert enclosed_share(points[:0], visible[:0], np.zeros(0, bool)) == 0
