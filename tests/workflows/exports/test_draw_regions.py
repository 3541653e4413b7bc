"""Regions are drawn where they are, and the picture is transparent elsewhere."""

import numpy as np
import pytest

from moseg.workflows.exports.draw_regions import RIM, RegionStyle, draw_regions

COLOURS = np.array([(0, 0, 0), (255, 0, 0), (0, 255, 0)], np.uint8)
PLAIN = RegionStyle(0.5)


def scene():
    regions = np.zeros((40, 60), np.uint16)
    regions[10:30, 10:25] = 1
    regions[10:30, 25:40] = 2
    return regions


def test_inside_is_tinted_the_border_is_full_and_the_rest_is_transparent():
    drawn = draw_regions(scene(), COLOURS, (40, 60), PLAIN)
    assert drawn.shape == (40, 60, 4)
    assert drawn[20, 17].tolist() == [255, 0, 0, 128]
    assert drawn[20, 32].tolist() == [0, 255, 0, 128]
    assert drawn[20, 10].tolist() == [255, 0, 0, 255]
    away = np.ones((40, 60), bool)
    away[10 - 2 - RIM : 30 + 2 + RIM, 10 - 2 - RIM : 40 + 2 + RIM] = False
    assert not drawn[away].any()


def test_a_dark_rim_separates_the_border_from_a_base_of_its_colour():
    column = draw_regions(scene(), COLOURS, (40, 60), PLAIN)[:10, 17]
    dark = (column[:, 3] > 60) & (column[:, 0] < 60)
    assert dark.any()


def test_touching_regions_have_a_line_between_them_unless_they_have_no_border():
    lined, bare = (draw_regions(scene(), COLOURS, (40, 60), style) for style in (PLAIN, RegionStyle(0.5, line=0)))
    assert lined[20, 24:26, 3].tolist() == [255, 255]
    assert bare[20, 24:26, 3].tolist() == [128, 128]


@pytest.mark.parametrize("shape", [(20, 30), (27, 41)])
def test_borders_keep_their_width_at_any_size(shape):
    drawn = draw_regions(scene(), COLOURS, shape, PLAIN)
    assert drawn.shape == (*shape, 4)
    # Red in the middle row up to the inside: two pixels, the outermost of them soft.
    row = drawn[shape[0] // 2, : shape[1] * 17 // 60].astype(int)
    assert 1 <= np.count_nonzero((row[:, 0] > 200) & (row[:, 3] > 200)) <= 3


def test_stripes_mark_pixels_that_do_not_count():
    hatched = np.zeros((40, 60), bool)
    hatched[32:40, 40:60] = True
    drawn = draw_regions(np.zeros((40, 60), np.uint16), COLOURS, (40, 60), PLAIN, hatched)
    assert 0.2 < np.mean(drawn[32:40, 40:60, 3] > 100) < 0.5
    assert not drawn[:32].any()
    assert np.ptp(drawn[32:40, 40:60, :3], axis=-1).max() == 0


def test_each_region_that_is_large_enough_has_its_number():
    regions = scene()
    regions[0:3, 0:3] = 2
    plain, numbered = (
        draw_regions(regions, COLOURS, (40, 60), RegionStyle(0.5, is_numbered=is_numbered))
        for is_numbered in (False, True)
    )
    changed = (plain != numbered).any(axis=-1)
    assert changed[12:28, 12:23].any()
    assert changed[12:28, 27:38].any()
    assert not changed[:8].any()
