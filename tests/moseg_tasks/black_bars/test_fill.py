"""Filled bars continue the border of the picture, which stays as it is."""

import numpy as np

from moseg.schemas.black_bars import BlackBars
from moseg.tasks.black_bars import fill_bars

BARS = BlackBars(left=3, top=2, right=1, bottom=4)


def test_each_pixel_of_a_bar_is_the_nearest_one_of_the_picture():
    image = np.random.default_rng(0).integers(0, 255, (12, 10, 3)).astype(np.uint8)
    before = image.copy()
    filled = fill_bars(image, BARS)
    rows, columns = np.clip(np.arange(12), 2, 7), np.clip(np.arange(10), 3, 8)
    assert np.array_equal(filled, image[rows][:, columns]) and filled.dtype == np.uint8
    assert np.array_equal(image, before)


def test_without_bars_a_frame_is_as_it_was():
    image = np.arange(12 * 10 * 3, dtype=np.uint8).reshape(12, 10, 3)
    assert np.array_equal(fill_bars(image, BlackBars()), image)
