"""The line about black bars: how wide they are in the video's own pixels, and what they mean for the result."""

import pytest

from moseg.schemas.black_bars import BlackBars
from moseg.workflows.exports.black_bars import describe_bars


def test_bars_that_are_left_out_are_named_in_the_videos_own_pixels():
    (line,) = describe_bars(BlackBars(0, 9, 0, 7), (60, 80), (120, 160), are_left_out=True)
    assert line == "black bars (18 px above, 14 px below) are left out: nothing is found in them"


def test_of_bars_that_count_as_scene_the_line_says_how_to_cut_them_off():
    (line,) = describe_bars(BlackBars(0, 9, 0, 7), (60, 80), (120, 160), are_left_out=False)
    assert "(18 px above, 14 px below) count as scene" in line and "crop=160:88:0:18 " in line
    (line,) = describe_bars(BlackBars(3, 0, 4, 0), (60, 80), (60, 80), are_left_out=False)
    # Encoders take even sizes: at most a pixel of the picture is lost.
    assert "(3 px left, 4 px right)" in line and "crop=72:60:4:0 " in line


@pytest.mark.parametrize("are_left_out", [True, False])
def test_without_bars_there_is_no_line(are_left_out):
    assert describe_bars(BlackBars(), (60, 80), (120, 160), are_left_out) == ()
