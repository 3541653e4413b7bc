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


def counted(moving, static, reliability=0.0, weight=1.0) -> ColourCount:
    return ColourCount(np.asarray(moving, np.float64), np.asarray(static, np.float64), reliability, weight)


def random_count(seed: int) -> ColourCount:
    rng = np.random.default_rng(seed)
    return counted(*rng.exponential(5, (2, SIZE)) * (rng.random((2, SIZE)) > 0.5), *rng.random(2))


def one_colour(index: int, amount: float = 1.0) -> np.ndarray:
    return amount * (np.arange(SIZE) == index)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 1000))
def test_swapping_the_sides_turns_the_sign(seed):
    count = random_count(seed)
    swapped = counted(count.static, count.moving)
    np.testing.assert_array_equal(colour_ratio(swapped, PARAMS), -colour_ratio(count, PARAMS))


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


def test_a_colour_has_neighbours_in_texture_too():
    params = PARAMS.model_copy(update={"texture_levels": 8, "texture_smoothing": 0.7})
    learnt, all_bins = np.zeros((2, *histogram_shape(params)))
    learnt[3, 3, 3, 4], all_bins[:] = 1, 1
    ratio = colour_ratio(counted(learnt.ravel(), all_bins.ravel()), params).reshape(learnt.shape)[3, 3, 3]
    assert ratio.argmax() == 4 and ratio[3] > ratio[2] > ratio[0]


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
