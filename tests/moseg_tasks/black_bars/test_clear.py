"""Masks without the pixels in bars, and without the objects that have no others."""

import numpy as np

from moseg.schemas.black_bars import BlackBars
from moseg.tasks.black_bars import clear_bars, keep_inside

BARS = BlackBars(left=2, bottom=1)


def _masks():
    masks = np.zeros((2, 6, 8), np.uint16)
    masks[0, 1:3, :2] = 1
    masks[0, 1:3, 5:7] = 2
    masks[1, 3:, 1:4] = 4
    return masks


def test_bars_are_cleared_and_the_picture_is_not():
    masks = _masks()
    cleared = clear_bars(masks, BARS)
    assert not cleared[:, :, :2].any() and not cleared[:, 5:].any()
    assert np.array_equal(cleared[:, :5, 2:], masks[:, :5, 2:])
    assert np.array_equal(masks, _masks())
    assert clear_bars(masks[0] > 0, BARS).dtype == bool


def test_objects_in_bars_alone_are_dropped_and_the_others_renumbered():
    masks, kept = keep_inside(_masks(), 4, BARS)
    # Object 3 has no pixel, in bars or elsewhere.
    assert kept.tolist() == [1, 2, 3]
    expected = clear_bars(_masks(), BARS)
    assert np.array_equal(masks, np.where(expected > 0, expected - 1, 0)) and masks.dtype == np.uint16


def test_a_section_without_objects_stays_so():
    masks, kept = keep_inside(np.zeros((2, 6, 8), np.uint16), 0, BARS)
    assert not masks.any() and kept.shape == (0,)
