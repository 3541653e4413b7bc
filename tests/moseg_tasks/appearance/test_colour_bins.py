import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import AppearanceParams
from moseg.tasks.appearance import colour_bins, histogram_shape

PARAMS = AppearanceParams(levels=16, texture_levels=8)
CORNERS = np.array([[[r, g, b] for r in (0, 255) for g in (0, 255) for b in (0, 255)]], np.uint8)


def grey(levels) -> np.ndarray:
    return np.repeat(np.asarray(levels, np.uint8)[None, :, None], 3, axis=2)


def split(bins: np.ndarray, params: AppearanceParams = PARAMS) -> tuple[np.ndarray, ...]:
    return np.unravel_index(bins, histogram_shape(params))


def test_grey_levels_keep_their_order_from_the_first_bin_of_lightness_to_the_last():
    lightness, a, b, _ = split(colour_bins(grey(range(256)), PARAMS))
    assert (np.diff(lightness.astype(int)) >= 0).all()
    assert lightness[0, 0] == 0 and lightness[0, -1] == PARAMS.levels - 1
    assert len(np.unique(lightness)) == PARAMS.levels
    assert np.ptp(a) <= 1 and np.ptp(b) <= 1


def test_grey_is_in_the_middle_of_both_ranges_of_chroma():
    _, a, b, _ = split(colour_bins(grey([128]), PARAMS))
    assert abs(int(a[0, 0]) - PARAMS.levels // 2) <= 1 and abs(int(b[0, 0]) - PARAMS.levels // 2) <= 1


def _striped(contrast: int) -> np.ndarray:
    """Return a grey image whose right half has stripes about the lightness of its left half."""
    levels = np.full((40, 40), 120)
    levels[:, 20:] += contrast * (-1) ** np.arange(20)
    return grey(levels.ravel()).reshape(40, 40, 3)


def test_what_is_rough_is_in_other_bins_than_what_is_plain():
    *_, plain = split(colour_bins(_striped(0), PARAMS))
    assert not plain.any()
    for contrast in (2, 15, 40):
        *_, texture = split(colour_bins(_striped(contrast), PARAMS))
        assert texture[:, 26:].min() > texture[:, :10].max() == 0


def test_texture_has_more_bins_for_small_deviations():
    deviations = [split(colour_bins(_striped(contrast), PARAMS))[3][:, 30].max() for contrast in (1, 4, 12, 40)]
    assert deviations == sorted({*deviations}) and deviations[-1] == PARAMS.texture_levels - 1


def test_with_a_single_bin_of_texture_there_is_colour_alone():
    params = AppearanceParams(texture_levels=1)
    rough, plain = (colour_bins(_striped(contrast), params)[:, :14] for contrast in (40, 0))
    assert np.array_equal(rough, plain) and not split(colour_bins(_striped(40), params), params)[3].any()


def test_red_and_green_and_blue_and_yellow_are_opposites():
    primaries = np.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 0]]], np.uint8)
    _, a, b, _ = (part[0] for part in split(colour_bins(primaries, PARAMS)))
    last = PARAMS.levels - 1
    assert a[0] == last and a[1] == 0 and b[2] == 0 and b[3] == last


@pytest.mark.parametrize("levels", [2, 7, 16, 20])
def test_the_colours_at_the_corners_of_the_cube_are_in_range(levels):
    params = AppearanceParams(levels=levels)
    bins = colour_bins(CORNERS, params)
    assert bins.dtype == np.uint16 and bins.shape == (1, 8)
    assert int(bins.max()) < np.prod(histogram_shape(params)) <= np.iinfo(np.uint16).max
    assert all(part.max() < size for part, size in zip(split(bins, params), histogram_shape(params), strict=True))
    assert split(bins, params)[0][0, 0] == 0 and split(bins, params)[0][0, -1] == levels - 1


@settings(max_examples=25, deadline=None)
@given(st.integers(2, 20), st.integers(0, 1000), st.integers(1, 9), st.integers(1, 9))
def test_a_bin_is_the_rounded_down_place_of_the_colour_in_cielab(levels, seed, height, width):
    params = AppearanceParams(levels=levels)
    image = np.random.default_rng(seed).integers(0, 256, (height, width, 3), dtype=np.uint8)
    lab = cv2.cvtColor(image.astype(np.float32) / 255, cv2.COLOR_RGB2LAB).astype(np.float64)
    ranges, starts = np.array([100, params.chroma_range, params.chroma_range]), np.array([0, 0.5, 0.5])
    places = (lab / ranges + starts) * levels
    byte = 2.6 * levels * np.array([100 / 255, 1, 1]) / ranges  # by which L, a and b kept in bytes may move a place
    found = np.stack(split(colour_bins(image, params), params)[:3], axis=-1)
    assert (found <= np.clip(places + byte, 0, levels - 1)).all()
    assert (found >= np.clip(places - byte, 0, levels - 1) - 1).all()


def test_the_image_is_left_as_it_was():
    image = CORNERS.copy()
    colour_bins(image, PARAMS)
    np.testing.assert_array_equal(image, CORNERS)


def test_more_bins_than_16_bits_count_are_refused():
    with pytest.raises(ValueError, match="at most 65536 bins"):
        AppearanceParams(levels=40, texture_levels=2)
