"""The line about graphics: how large they are and where, in the video's own pixels, and what they mean."""

import pytest

from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.workflows.exports.screen_graphics import describe_graphics

LOGO = ((10, 5), (19, 5), (19, 12), (10, 12))
ANALYSED, SHAPE = (60, 80), (120, 160)


def _describe(*parts, shape=SHAPE, are_left_out=True):
    return describe_graphics(ScreenGraphics(parts), ANALYSED, shape, are_left_out)


def test_graphics_that_are_left_out_are_named_in_the_videos_own_pixels():
    (line,) = _describe(LOGO)
    assert line == "graphics in the frames (20 x 16 px at 20, 10) are left out: what is around them stands for them"


def test_of_graphics_that_count_as_scene_the_line_says_that_they_may_be_taken_for_objects():
    (line,) = _describe(LOGO, are_left_out=False)
    assert line == "graphics in the frames (20 x 16 px at 20, 10) count as scene: they may be taken for objects"


def test_sides_may_be_scaled_differently():
    (line,) = _describe(LOGO, shape=(60, 240))
    assert "(30 x 8 px at 30, 5)" in line


def test_a_part_is_named_by_its_bounding_box():
    (line,) = _describe(((30, 20), (34, 24), (30, 28), (26, 24)), shape=ANALYSED)
    assert "(9 x 9 px at 26, 20)" in line


def test_lists_of_a_recipe_do_as_well_as_tuples():
    assert _describe([[*corner] for corner in LOGO]) == _describe(LOGO)


def _logos(number, gap):
    return [[(x + index * (10 + gap), y) for x, y in LOGO] for index in range(number)]


@pytest.mark.parametrize("number", [1, 2, 4])
def test_each_of_a_few_graphics_is_named(number):
    (line,) = _describe(*_logos(number, gap=5))
    assert line.count("20 x 16 px") == number and "others" not in line


def test_of_many_graphics_the_first_ones_are_named():
    (line,) = _describe(*_logos(9, gap=5))
    assert line.count("20 x 16 px") == 4 and "at 110, 10; and others)" in line


def test_parts_as_near_as_letters_are_one_graphic():
    first, *middle, last = _logos(5, gap=4)
    (line,) = _describe(first, last, *middle)
    assert "(132 x 16 px at 20, 10)" in line


@pytest.mark.parametrize("are_left_out", [True, False])
def test_without_graphics_there_is_no_line(are_left_out):
    assert _describe(are_left_out=are_left_out) == ()
