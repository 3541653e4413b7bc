"""Convex parts cover a region and little more; a plain ground belongs to the letters on it."""

import cv2
import numpy as np
import pytest

from moseg.schemas.parameters import ScreenGraphicsParams
from moseg.schemas.screen_graphics import ScreenGraphics
from moseg.tasks.screen_graphics import graphics_mask
from moseg.tasks.screen_graphics.regions import convex_parts, with_plain_ground

SHAPE = HEIGHT, WIDTH = 90, 120


def _outline():
    mask = np.zeros(SHAPE, np.uint8)
    return cv2.rectangle(mask, (15, 10), (105, 80), 1, 5) > 0


def _letters():
    return cv2.putText(np.zeros(SHAPE, np.uint8), "L V 5", (10, 60), cv2.FONT_HERSHEY_SIMPLEX, 1.2, 1, 4) > 0


def _spots():
    mask = np.zeros(SHAPE, bool)
    mask[0, 0] = mask[40:43, 70] = mask[-1, -1] = True
    return mask


def _covered(mask, smallest=8):
    parts = [polygon.tolist() for polygon in convex_parts(mask, smallest)]
    return graphics_mask(ScreenGraphics(parts), mask.shape)


@pytest.mark.parametrize("make", [_outline, _letters, _spots])
def test_each_pixel_of_a_mask_is_covered(make):
    mask = make()
    assert _covered(mask)[mask].all()


def test_parts_are_convex():
    for polygon in convex_parts(_letters(), 8):
        assert len(polygon) < 3 or cv2.isContourConvex(polygon)


def test_a_solid_region_is_one_part_of_its_own_area():
    disc = cv2.circle(np.zeros(SHAPE, np.uint8), (60, 45), 30, 1, -1) > 0
    assert len([*convex_parts(disc, 8)]) == 1
    assert _covered(disc)[disc].all() and _covered(disc).sum() < 1.05 * disc.sum()


def test_the_inside_of_an_outline_stays_uncovered():
    """A corner of it may be one part, whose hull is at most twice as large."""
    mask = _outline()
    covered = _covered(mask)
    assert not covered[30:60, 35:85].any() and covered.sum() < 2 * mask.sum()


def test_parts_are_not_divided_below_the_smallest_side():
    mask = _outline()
    numbers = [len([*convex_parts(mask, smallest)]) for smallest in (max(SHAPE), 60, 8)]
    assert numbers == sorted({*numbers}) and numbers[0] == 1


def test_an_empty_mask_has_no_parts():
    assert not [*convex_parts(np.zeros(SHAPE, bool), 8)]


BOX = np.s_[30:60, 40:80]


def _filmed():
    """Return frames of a scene that changes around a plain box."""
    frames = np.random.default_rng(0).integers(0, 256, (12, *SHAPE, 3)).astype(np.uint8)
    frames[:, *BOX] = 40
    return frames


def _region():
    region = np.zeros(SHAPE, bool)
    region[36:54, 48:72] = True
    return region


def _ground(region, frames, **params):
    return with_plain_ground(region, frames, ScreenGraphicsParams(**params), join=2)


def test_a_plain_ground_is_added_and_the_scene_is_not():
    grown = _ground(_region(), _filmed())
    # Within the pixels at its border.
    assert grown[BOX].all() and np.array_equal(np.argwhere(grown)[[0, -1]], [[28, 38], [61, 81]])


def test_a_plain_ground_that_goes_on_beyond_the_reach_is_that_of_a_scene_of_one_colour():
    assert np.array_equal(_ground(_region(), _filmed(), reach=0.1), _region())


def test_ground_of_another_colour_beside_it_is_not_added():
    """A sky that changes as little as a sign is told from it by the border between them."""
    frames = _filmed()
    frames[:, :30] = 220
    grown = _ground(_region(), frames)
    assert grown[BOX].all() and not grown[:27].any()


def test_other_plain_places_nearby_are_not_added():
    frames = _filmed()
    frames[:, 20:28, 40:50] = 40
    assert not _ground(_region(), frames)[20:28].any()


def test_a_region_in_a_scene_that_changes_everywhere_stays_as_it_is():
    frames = np.random.default_rng(0).integers(0, 256, (12, *SHAPE, 3)).astype(np.uint8)
    assert np.array_equal(_ground(_region(), frames), _region())


def test_a_region_that_fills_the_frame_stays_as_it_is():
    region = np.ones(SHAPE, bool)
    assert np.array_equal(_ground(region, _filmed()), region)
