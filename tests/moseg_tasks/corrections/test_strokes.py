import numpy as np
import pytest

from moseg.schemas.corrections import Stroke
from moseg.tasks.corrections.strokes import analysed_points, draw_strokes

SIZE = (60, 80)


def stroke(radius, *points):
    return Stroke(radius=radius, points=points)


def test_a_point_is_a_disc():
    drawn = draw_strokes([stroke(10, (40, 30))], SIZE, SIZE)
    y, x = np.ogrid[:60, :80]
    np.testing.assert_array_equal(drawn, (x - 40) ** 2 + (y - 30) ** 2 <= 100)


def test_a_line_covers_what_lies_within_its_radius():
    drawn = draw_strokes([stroke(3, (10, 30), (60, 30))], SIZE, SIZE)
    assert drawn[27:34, 10:61].all() and not drawn[:27].any() and not drawn[34:].any()
    assert drawn[30, 7] and not drawn[30, 6] and drawn[30, 63] and not drawn[30, 64]


def test_a_polyline_is_its_lines():
    corner = draw_strokes([stroke(2, (10, 10), (40, 10), (40, 50))], SIZE, SIZE)
    lines = draw_strokes([stroke(2, (10, 10), (40, 10)), stroke(2, (40, 10), (40, 50))], SIZE, SIZE)
    np.testing.assert_array_equal(corner, lines)


@pytest.mark.parametrize("radius", [0.01, 0.5])
def test_a_thin_stroke_has_no_gaps(radius):
    drawn = draw_strokes([stroke(radius, (5.3, 7.7), (70.1, 52.2))], SIZE, SIZE)
    assert drawn[:, 6:70].any(axis=0).all()


def test_strokes_reach_beyond_the_frame():
    drawn = draw_strokes([stroke(5, (-20, 30), (2, 30)), stroke(1, (500, 500))], SIZE, SIZE)
    assert drawn[30, :8].all() and not drawn[30, 8:].any() and drawn.sum() < 90


def test_strokes_are_in_px_of_the_videos_own_frames():
    small = draw_strokes([stroke(10, (40, 30))], SIZE, SIZE)
    # Pixel centres are at integers, so that a frame of twice the size has the same place at 2 x + 1/2.
    large = draw_strokes([stroke(20, (80.5, 60.5))], SIZE, (120, 160))
    np.testing.assert_array_equal(small, large)
    np.testing.assert_allclose(
        analysed_points([(-0.5, -0.5), (159.5, 119.5)], SIZE, (120, 160)), [[-0.5, -0.5], [79.5, 59.5]]
    )


def test_a_brush_has_the_mean_scale_of_both_axes():
    drawn = stroke(20, (79.5, 47.5))
    assert draw_strokes([drawn], (96, 40), (96, 160)).any(axis=1).sum() in (24, 25)
    assert draw_strokes([drawn], (24, 160), (96, 160)).any(axis=0).sum() in (24, 25, 26)
