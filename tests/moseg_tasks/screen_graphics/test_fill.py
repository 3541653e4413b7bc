"""Graphics and bars are filled with the nearest pixel of the scene, which stays as it is."""

import numpy as np
import pytest

from moseg.schemas.black_bars import BlackBars
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.tasks.screen_graphics import fill_graphics, graphics_mask

SHAPE = HEIGHT, WIDTH = 40, 60
NO_BARS = BlackBars()
BARS = BlackBars(left=7, top=3, bottom=4)
GRAPHICS = ScreenGraphics((((20, 10), (45, 12), (40, 24), (22, 25)), ((0, 30), (12, 30), (12, 39), (0, 39))))
APPROXIMATION = 1.05
"""OpenCV's distance transform by 5 x 5 pixels may be off by some percent."""


def _numbered():
    """Return an image in which each pixel has a colour of its own."""
    numbers = np.arange(HEIGHT * WIDTH).reshape(SHAPE)
    return np.stack([numbers % 256, numbers // 256, np.full(SHAPE, 9)], axis=-1).astype(np.uint8)


def _sources(filled):
    """Return the places yx (y, x, 2) of the pixels of `_numbered` from which a filled image is made."""
    numbers = filled[..., 0].astype(int) + 256 * filled[..., 1].astype(int)
    return np.stack(np.unravel_index(numbers, SHAPE), axis=-1)


def _hidden(graphics, bars):
    hidden = np.ones(SHAPE, bool)
    picture = bars.picture(SHAPE)
    hidden[picture] = graphics_mask(graphics, SHAPE)[picture]
    return hidden


def test_a_mask_has_the_inside_and_the_border_of_each_polygon():
    mask = graphics_mask(ScreenGraphics((((2, 1), (4, 1), (4, 3), (2, 3)), ((9, 9),))), (10, 12))
    expected = np.zeros((10, 12), bool)
    expected[1:4, 2:5] = expected[9, 9] = True
    assert np.array_equal(mask, expected)


def test_what_lies_beyond_the_frame_is_cut_off():
    mask = graphics_mask(ScreenGraphics((((-3, -2), (2, -2), (2, 1), (-3, 1)),)), (5, 6))
    assert mask.sum() == 6 and mask[:2, :3].all()


@pytest.mark.parametrize("bars", [NO_BARS, BARS])
def test_each_filled_pixel_is_the_nearest_one_of_the_scene(bars):
    hidden = _hidden(GRAPHICS, bars)
    sources, seen = _sources(fill_graphics(_numbered(), GRAPHICS, bars)), np.argwhere(~hidden)
    assert not hidden[sources[..., 0], sources[..., 1]].any()
    for place in np.argwhere(hidden):
        shortest = np.linalg.norm(seen - place, axis=1).min()
        assert np.linalg.norm(sources[*place] - place) <= APPROXIMATION * shortest


@pytest.mark.parametrize("bars", [NO_BARS, BARS])
def test_the_scene_stays_as_it_is(bars):
    image = _numbered()
    filled, seen = fill_graphics(image, GRAPHICS, bars), ~_hidden(GRAPHICS, bars)
    assert np.array_equal(filled[seen], image[seen]) and filled.dtype == np.uint8
    assert np.array_equal(image, _numbered())


def test_nothing_of_bars_and_graphics_is_left():
    image = _numbered() // 2
    image[_hidden(GRAPHICS, BARS)] = 255
    assert fill_graphics(image, GRAPHICS, BARS).max() < 255


def test_lists_of_a_recipe_do_as_well_as_tuples():
    as_read = ScreenGraphics(**GRAPHICS.as_json())
    assert isinstance(as_read.parts, list)
    assert np.array_equal(graphics_mask(as_read, SHAPE), graphics_mask(GRAPHICS, SHAPE))
    assert np.array_equal(fill_graphics(_numbered(), as_read, BARS), fill_graphics(_numbered(), GRAPHICS, BARS))


def test_frames_of_several_sizes_are_filled_each_at_its_own():
    small = np.full((30, 50, 3), 5, np.uint8)
    assert fill_graphics(_numbered(), GRAPHICS, NO_BARS).shape == (*SHAPE, 3)
    assert np.array_equal(fill_graphics(small, GRAPHICS, NO_BARS), small)


def test_graphics_are_moved_into_the_frame_by_the_width_of_bars():
    moved = GRAPHICS.moved(5, 2)
    assert moved.parts[0][0] == (25, 12)
    before, after = (graphics_mask(each, (60, 80)) for each in (GRAPHICS, moved))
    assert np.array_equal(after[2:, 5:], before[:-2, :-5]) and after.sum() == before.sum()
