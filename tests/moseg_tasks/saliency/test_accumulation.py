import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import AccumulationParams
from moseg.tasks.saliency import accumulate, flow_consistency, memory_weight

PARAMS = AccumulationParams()
SHAPE = (24, 40)
ROUNDING = 1e-3  # of float16 under 1


def still(num_frames: int) -> list[np.ndarray]:
    return [np.zeros((*SHAPE, 2), np.float32)] * num_frames


def random_pass(seed: int, num_frames: int, channels: int = 3):
    """Maps, flows and weights of a pass, of any content."""
    rng = np.random.default_rng(seed)
    maps = rng.random((num_frames, *SHAPE, channels), np.float32)
    flows = rng.normal(0, 2.5, (num_frames, *SHAPE, 2)).astype(np.float32)
    return list(maps), list(flows), list(rng.random((num_frames, *SHAPE, channels), np.float32))


def both_ways(saliency: np.ndarray, flows: np.ndarray) -> np.ndarray:
    """Mean of a pass from the past and one from the future, of maps (T, y, x) and flows (T, 2, y, x, 2)."""
    consistency = flow_consistency(list(flows), PARAMS)
    passes = []
    for direction, order in enumerate((slice(None), slice(None, None, -1))):
        weights = [memory_weight(each, direction, PARAMS)[..., None] for each in consistency]
        maps, along = saliency[..., None], flows[:, direction]
        passes.append(accumulate(maps[order], along[order], weights[order])[order, ..., 0].astype(np.float32))
    return (passes[0] + passes[1]) / 2


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.integers(2, 7), st.integers(1, 4), st.data())
def test_a_video_cut_at_any_frame_and_carried_on_gives_the_bytes_of_one_that_is_not(seed, num_frames, channels, data):
    maps, flows, weights = random_pass(seed, num_frames, channels)
    cut = data.draw(st.integers(1, num_frames - 1))
    whole = accumulate(maps, flows, weights)
    head = accumulate(maps[:cut], flows[:cut], weights[:cut])
    tail = accumulate(maps[cut:], flows[cut:], weights[cut:], head[-1])
    assert np.concatenate([head, tail]).tobytes() == whole.tobytes()
    # Without what is carried the cut shows.
    assert accumulate(maps[cut:], flows[cut:], weights[cut:]).tobytes() != tail.tobytes()


@settings(max_examples=10, deadline=None)
@given(st.floats(0, 1, width=16), st.integers(1, 6), st.integers(0, 1000))
def test_a_constant_map_stays_constant_under_any_flow_and_weight(level, num_frames, seed):
    _, flows, weights = random_pass(seed, num_frames)
    maps = [np.full((*SHAPE, 3), level, np.float32)] * num_frames
    np.testing.assert_array_equal(accumulate(maps, flows, weights), np.float16(level))


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 1000), st.integers(1, 6))
def test_maps_in_range_accumulate_in_range_and_are_left_as_they_were(seed, num_frames):
    maps, flows, weights = random_pass(seed, num_frames)
    before = [array.copy() for array in (*maps, *flows, *weights)]
    accumulated = accumulate(maps, flows, weights)
    assert accumulated.dtype == np.float16 and accumulated.shape == (num_frames, *SHAPE, 3)
    assert accumulated.min() >= 0 and accumulated.max() <= 1
    assert all(np.array_equal(*pair) for pair in zip(before, (*maps, *flows, *weights), strict=True))


@settings(max_examples=10, deadline=None)
@given(st.integers(1, 6), st.integers(0, 1000))
def test_reversing_time_reverses_the_mean_of_both_passes(num_frames, seed):
    rng = np.random.default_rng(seed)
    saliency = rng.random((num_frames, *SHAPE), np.float32)
    flows = rng.normal(0, 1.5, (num_frames, 2, *SHAPE, 2)).astype(np.float32)
    reverse = both_ways(saliency[::-1], flows[::-1, ::-1])
    np.testing.assert_array_equal(reverse[::-1], both_ways(saliency, flows))


def test_the_first_frame_of_a_pass_is_its_own_accumulation():
    maps, flows, weights = random_pass(0, 1)
    np.testing.assert_array_equal(accumulate(maps, flows, weights)[0], maps[0].astype(np.float16))


def test_each_channel_is_accumulated_on_its_own():
    maps, flows, weights = random_pass(4, 4)
    whole = accumulate(maps, flows, weights)
    for channel in range(3):
        own = [channel]
        alone = accumulate([each[..., own] for each in maps], flows, [each[..., own] for each in weights])
        np.testing.assert_allclose(alone, whole[..., own], atol=ROUNDING)


def test_a_flash_is_forgotten_by_the_memory_s_factor_a_frame():
    maps = [np.full((*SHAPE, 1), t == 0, np.float32) for t in range(9)]
    accumulated = accumulate(maps, still(9), [PARAMS.memory] * 9)[:, 12, 20, 0]
    np.testing.assert_allclose(accumulated, PARAMS.memory ** np.arange(9), rtol=9 * 2**-11)


def test_weight_zero_is_the_map_itself_and_weight_one_the_memory():
    maps, flows, _ = random_pass(1, 3)
    np.testing.assert_array_equal(accumulate(maps, flows, [0.0] * 3), np.stack(maps).astype(np.float16))
    kept = accumulate(maps, still(3), [1.0] * 3)
    np.testing.assert_allclose(kept[2], maps[0], atol=ROUNDING)


def test_the_memory_follows_the_flow():
    maps = np.zeros((6, *SHAPE, 1), np.float32)
    for t in range(6):
        maps[t, 8:16, 4 + 3 * t : 12 + 3 * t] = 1
    maps[3] = 0  # the object stops being seen for a frame
    to_previous = np.zeros((6, *SHAPE, 2), np.float32)
    to_previous[..., 0] = -3
    accumulated = accumulate(maps, to_previous, [PARAMS.memory] * 6)[..., 0]
    assert accumulated[3, 9:15, 14:20].min() > 0.8
    assert accumulated[3, 9:15, :12].max() < 0.1


def test_a_pixel_that_comes_from_outside_remembers_the_border_nearest_to_it():
    memory = np.zeros((*SHAPE, 1), np.float16)
    memory[:, 0] = 0.5
    leftwards = np.full((*SHAPE, 2), (-1e4, 0.0), np.float32)
    seen = [np.zeros((*SHAPE, 1), np.float32)]
    np.testing.assert_array_equal(accumulate(seen, [leftwards], [1.0], memory), np.float16(0.5))


def test_the_memory_counts_its_full_weight_where_the_flow_is_consistent_both_ways():
    weight = memory_weight(np.ones((2, *SHAPE), np.float32), 0, PARAMS)
    assert weight.shape == SHAPE and weight.dtype == np.float32
    np.testing.assert_allclose(weight, PARAMS.memory, rtol=1e-6)


def test_a_frame_without_consistent_flow_has_little_weight():
    own_share = 1 - memory_weight(np.zeros((2, 1, 1), np.float32), 0, PARAMS)
    np.testing.assert_allclose(
        own_share, PARAMS.reliability_floor * (1 - PARAMS.memory * PARAMS.consistency_floor), rtol=1e-5
    )


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 1000), st.sampled_from([0, 1]))
def test_the_weight_grows_with_the_consistency_of_the_way_the_memory_came(seed, direction):
    rng = np.random.default_rng(seed)
    consistency = np.sort(rng.random((2, *SHAPE), np.float32), axis=0)  # in row 1 the greater: it stays the maximum
    lower = consistency if direction == 0 else consistency[::-1]
    higher = lower.copy()
    higher[direction] = (higher[direction] + consistency[1]) / 2
    before, after = (memory_weight(each, direction, PARAMS) for each in (lower, higher))
    assert (after >= before).all() and (before >= 0).all() and (after <= 1).all()
    assert (after > before)[higher[direction] > PARAMS.consistency_floor + 0.01].all()


def test_the_way_the_memory_came_is_the_direction_asked_for():
    consistency = np.stack([np.ones(SHAPE, np.float32), np.full(SHAPE, 0.6, np.float32)])
    assert memory_weight(consistency, 0, PARAMS).min() > memory_weight(consistency, 1, PARAMS).max() + 0.1


@pytest.mark.parametrize("shape", [(1, 1), (1, 5), (5, 1)])
def test_frames_of_a_pixel_or_a_row_accumulate(shape):
    maps = [np.full((*shape, 1), level, np.float32) for level in (0.0, 1.0)]
    flows = [np.full((*shape, 2), 3.5, np.float32)] * 2
    accumulated = accumulate(maps, flows, [0.5, 0.5])
    assert accumulated.shape == (2, *shape, 1)
    np.testing.assert_array_equal(accumulated[1], np.float16(0.5))
