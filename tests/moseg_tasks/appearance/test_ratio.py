import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import AppearanceParams
from moseg.tasks.appearance import ColourCount, colour_ratio, histogram_shape, pool_sections

PARAMS = AppearanceParams(levels=6, smoothing=1.0, texture_levels=1, doubt=0.0)
SIZE = math.prod(histogram_shape(PARAMS))
EMPTY = np.zeros(SIZE)


def counted(moving, static, reliability=0.0, weight=1.0, textures=None) -> ColourCount:
    sides = np.asarray([moving, static], np.float64)
    return ColourCount(*sides, *(np.zeros_like(sides) if textures is None else textures), reliability, weight)


def random_count(seed: int, params: AppearanceParams = PARAMS) -> ColourCount:
    """Return a random count whose textures have colours of the same weight on both sides."""
    rng = np.random.default_rng(seed)
    shape = histogram_shape(params)
    sides, textures = rng.exponential(5, (2, 2, *shape))
    sides *= rng.random(sides.shape) > 0.5
    textures *= rng.random(shape[:3])[..., None] / textures.sum(axis=-1, keepdims=True)
    return counted(*sides.reshape(2, -1), *rng.random(2), textures.reshape(2, -1))


def one_colour(index: int, amount: float = 1.0) -> np.ndarray:
    return amount * (np.arange(SIZE) == index)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([1, 4]))
def test_swapping_the_sides_turns_the_sign(seed, texture_levels):
    params = PARAMS.model_copy(update={"texture_levels": texture_levels})
    count = random_count(seed, params)
    swapped = counted(count.static, count.moving, textures=(count.static_textures, count.moving_textures))
    np.testing.assert_allclose(colour_ratio(swapped, params), -colour_ratio(count, params), atol=1e-6)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.floats(0.01, 100), st.floats(0.01, 100))
def test_how_much_of_the_frame_moves_does_not_matter(seed, more, fewer):
    count = random_count(seed)
    scaled = counted(more * count.moving, fewer * count.static)
    np.testing.assert_allclose(colour_ratio(scaled, PARAMS), colour_ratio(count, PARAMS), atol=1e-5)


@pytest.mark.parametrize(("moving", "static"), [(EMPTY, one_colour(3)), (one_colour(3), EMPTY), (EMPTY, EMPTY)])
def test_a_side_without_colours_says_nothing(moving, static):
    ratio = colour_ratio(counted(moving, static), PARAMS)
    assert ratio.dtype == np.float32 and ratio.shape == (SIZE,) and not ratio.any()


def test_the_same_colours_on_both_sides_say_nothing():
    count = random_count(0)
    np.testing.assert_allclose(colour_ratio(counted(count.moving, 3 * count.moving), PARAMS), 0, atol=1e-6)


def test_the_ratio_is_the_log_of_the_shares():
    sharp = PARAMS.model_copy(update={"smoothing": 0.0})
    moving, static = one_colour(3, 9.0) + one_colour(50, 3.0), one_colour(3, 1.0) + one_colour(50, 7.0)
    ratio = colour_ratio(counted(moving, static), sharp)
    np.testing.assert_allclose(ratio[[3, 50, 100]], [np.log(0.75 / 0.125), np.log(0.25 / 0.875), 0], atol=1e-4)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 1000), st.floats(0.1, 5))
def test_the_ratio_is_clipped_both_ways(seed, clip):
    params = PARAMS.model_copy(update={"clip": clip, "smoothing": 0.0})
    count = random_count(seed)
    ratio = colour_ratio(counted(count.moving + one_colour(7, 100), count.static * (np.arange(SIZE) != 7)), params)
    assert ratio[7] == np.float32(clip) and np.abs(ratio).max() == np.float32(clip)


def test_neighbouring_colours_share_what_is_learnt():
    middle = (2 * 6 + 2) * 6 + 2
    ratio = colour_ratio(counted(one_colour(middle), np.ones(SIZE)), PARAMS)
    for step in (1, 6, 36):
        assert ratio[middle] > ratio[middle + step] > ratio[middle + 2 * step] + 0.5
    sharp = colour_ratio(counted(one_colour(middle), np.ones(SIZE)), PARAMS.model_copy(update={"smoothing": 0.0}))
    assert sharp[middle] > 0 > sharp[middle + 1]


def textured(moving, static, **settings) -> np.ndarray:
    """Return the ratio of textures 0 to 3 of a colour that is as usual in what moves as in the background.

    `moving` and `static` are the counts of these textures in frames that have the colour on both sides.
    """
    params = PARAMS.model_copy(update={"texture_levels": 4, "smoothing": 0.0, "texture_smoothing": 0.0, **settings})
    textures = np.zeros((2, *histogram_shape(params)))
    textures[:, 3, 3, 3] = moving, static
    everywhere = np.ones((2, textures[0].size))
    ratio = colour_ratio(counted(*everywhere, textures=textures.reshape(2, -1)), params).reshape(textures.shape[1:])
    assert not ratio[:3].any() and not ratio[4:].any()
    return ratio[3, 3, 3]


def test_textures_tell_apart_what_has_one_colour():
    found = textured([8, 2, 0, 0], [2, 8, 0, 0], texture_doubt=4.0)
    np.testing.assert_allclose(found, [np.log(10 / 4), np.log(4 / 10), 0, 0], rtol=1e-6)


def test_few_pixels_of_a_colour_say_little_about_its_textures():
    few, many, very_many = (textured([9 * n, n, 0, 0], [n, 9 * n, 0, 0])[0] for n in (1e-3, 1, 1e6))
    assert 0 < few < 0.05 and 0.5 < many < np.log(9) and very_many == pytest.approx(np.log(9), rel=1e-4)


def test_a_texture_that_only_one_side_has_says_the_more_the_more_pixels_show_it():
    found = [textured([n, 0, 0, 0], [0, n, 0, 0], texture_doubt=2.0)[:2] for n in (1, 10, 100)]
    for count, (moves, rests) in zip((1, 10, 100), found, strict=True):
        assert moves == pytest.approx(min(np.log(1 + count), PARAMS.clip), rel=1e-5) and rests == -moves


def test_a_colour_has_neighbours_in_texture_too():
    apart = textured([0, 0, 0, 8], [8, 0, 0, 0])
    near = textured([0, 0, 0, 8], [8, 0, 0, 0], texture_smoothing=0.7)
    assert apart[1] == apart[2] == 0 and near[3] > near[2] > 0 > near[1] > near[0]


def test_colour_and_texture_add_up():
    params = PARAMS.model_copy(update={"texture_levels": 4, "smoothing": 0.0, "texture_smoothing": 0.0})
    sides, textures = np.full((2, 2, *histogram_shape(params)), 1e-3)
    sides[0, 3, 3, 3], sides[1, 3, 3, 3] = 3, 1
    textures[:] = 0
    textures[:, 3, 3, 3] = [[1e6, 3e6, 0, 0], [3e6, 1e6, 0, 0]]
    ratio = colour_ratio(counted(*sides.reshape(2, -1), textures=textures.reshape(2, -1)), params)
    shares = sides.reshape(2, -1) / sides.reshape(2, -1).sum(axis=1, keepdims=True)
    colour = np.log(shares[0].reshape(sides[0].shape)[3, 3, 3, 0] / shares[1].reshape(sides[0].shape)[3, 3, 3, 0])
    expected = [colour - np.log(3), colour + np.log(3), colour, colour]
    np.testing.assert_allclose(ratio.reshape(sides[0].shape)[3, 3, 3], expected, atol=1e-3)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000), st.lists(st.floats(-200, 200), min_size=1, max_size=5), st.floats(0, 1))
def test_sections_count_by_the_memory_to_the_power_of_their_distance(seed, centres, memory):
    counts = [random_count(seed + i) for i in range(len(centres))]
    pooled = pool_sections(counts, centres, 10.0, memory)
    weights = [memory ** abs(centre - 10.0) for centre in centres]
    for index, name in enumerate(ColourCount._fields):
        expected = np.tensordot(weights, [count[index] for count in counts], axes=1)
        np.testing.assert_allclose(getattr(pooled, name), expected, rtol=1e-9, atol=1e-300)


def test_the_section_looked_at_counts_in_full_and_without_memory_alone():
    counts = [random_count(i) for i in range(3)]
    alone = pool_sections(counts, [0.0, 8.0, 16.0], 8.0, 0.0)
    forever = pool_sections(counts, [0.0, 8.0, 16.0], 8.0, 1.0)
    np.testing.assert_array_equal(alone.moving, counts[1].moving)
    np.testing.assert_allclose(forever.static, sum(count.static for count in counts))


def test_past_and_future_sections_count_equally():
    count, other = random_count(0), random_count(1)
    before = pool_sections([count, other], [2.0, 8.0], 8.0, 0.9)
    behind = pool_sections([other, count], [8.0, 14.0], 8.0, 0.9)
    np.testing.assert_allclose(before.moving, behind.moving)


def test_the_ratio_shrinks_with_the_weight_and_is_zero_without_any():
    params = AppearanceParams(levels=6, texture_levels=1, doubt=20.0)
    sides = random_count(3)[:2]
    sure = colour_ratio(counted(*sides, weight=1e12), params)
    np.testing.assert_allclose(colour_ratio(counted(*sides, weight=20.0), params), sure / 2, rtol=1e-6)
    assert sure.any() and not colour_ratio(counted(*sides, weight=0.0), params).any()
