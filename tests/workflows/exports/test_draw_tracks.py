"""Points are drawn where they are visible, with a tail along their path."""

import numpy as np

from moseg.workflows.exports.draw_tracks import TAIL_FRAMES, DrawnPoints, draw_tracks

RED = np.array([(255, 0, 0)], np.uint8)


def track(num_frames, hidden=()):
    """A point that moves 3 px/frame to the right and ends at x = 60, y = 20."""
    x = 60 - 3.0 * np.arange(num_frames)[::-1]
    points = np.stack([x, np.full(num_frames, 20.0)], axis=-1)[None]
    visible = np.ones((1, num_frames), bool)
    visible[0, list(hidden)] = False
    return DrawnPoints(points, visible, RED, (40, 80))


def columns(drawn):
    """Columns in which anything is drawn."""
    return np.flatnonzero(drawn[..., 3].any(axis=0))


def test_a_dot_has_its_colour_and_a_dark_rim_and_the_rest_is_transparent():
    drawn = draw_tracks(track(1), (40, 80), radius=2)
    assert drawn.shape == (40, 80, 4)
    assert drawn[20, 60].tolist() == [255, 0, 0, 255]
    rim = drawn[17, 60]
    assert rim[3] > 60
    assert rim[0] < 130
    rows = np.flatnonzero(drawn[..., 3].any(axis=1))
    assert (rows.min(), rows.max()) == (17, 23)
    assert (columns(drawn).min(), columns(drawn).max()) == (57, 63)


def test_a_tail_has_its_length_and_fades():
    drawn = draw_tracks(track(20), (40, 80), radius=2)
    assert abs(columns(drawn).min() - (60 - 3 * TAIL_FRAMES)) <= 1
    old, new = drawn[20, 60 - 3 * TAIL_FRAMES + 2, 3], drawn[20, 54, 3]
    assert 0 < old < new


def test_a_tail_ends_at_a_gap():
    drawn = draw_tracks(track(8, hidden=[4]), (40, 80), radius=2)
    assert abs(columns(drawn).min() - (60 - 2 * 3)) <= 1


def test_points_hidden_in_the_last_frame_are_not_drawn():
    assert not draw_tracks(track(5, hidden=[4]), (40, 80), radius=2).any()


def test_points_are_placed_at_the_size_of_the_picture():
    drawn = draw_tracks(track(1), (20, 40), radius=2)
    y, x = np.nonzero(drawn[..., 3])
    # The centre of pixel (60, 20) of a picture twice as large.
    np.testing.assert_allclose((x.mean(), y.mean()), (60.5 / 2 - 0.5, 20.5 / 2 - 0.5), atol=0.3)
