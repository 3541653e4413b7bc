import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg_tasks.saliency import accumulate_saliency
from schemas.parameters import ProposalParams

PARAMS = ProposalParams()
SHAPE = (24, 40)


def still(num_frames: int) -> np.ndarray:
    return np.zeros((num_frames, 2, *SHAPE, 2), np.float32)


def moving(num_frames: int, speed: int) -> np.ndarray:
    flows = still(num_frames)
    flows[1:, 0, ..., 0] = -speed
    flows[:-1, 1, ..., 0] = speed
    return flows


def random_case(seed: int, num_frames: int):
    rng = np.random.default_rng(seed)
    flows = rng.normal(0, 1.5, (num_frames, 2, *SHAPE, 2)).astype(np.float32)
    return rng.random((num_frames, *SHAPE), np.float32), flows


@settings(max_examples=10, deadline=None)
@given(st.floats(0, 1, width=32), st.integers(1, 6), st.integers(0, 1000))
def test_constant_saliency_stays_constant_under_any_flow(level, num_frames, seed):
    saliency = np.full((num_frames, *SHAPE), level, np.float32)
    np.testing.assert_allclose(
        accumulate_saliency(saliency, random_case(seed, num_frames)[1], PARAMS), level, atol=1e-6
    )


@settings(max_examples=10, deadline=None)
@given(st.integers(1, 6), st.integers(0, 1000))
def test_reversing_time_reverses_the_result(num_frames, seed):
    saliency, flows = random_case(seed, num_frames)
    forward = accumulate_saliency(saliency, flows, PARAMS)
    reverse = accumulate_saliency(saliency[::-1], flows[::-1, ::-1], PARAMS)
    np.testing.assert_allclose(reverse[::-1], forward, atol=1e-6)
    assert forward.min() >= 0 and forward.max() <= 1


def test_a_flash_is_forgotten_by_the_memory_s_factor_a_frame():
    saliency = np.zeros((9, *SHAPE), np.float32)
    saliency[0] = 1
    accumulated = accumulate_saliency(saliency, still(9), PARAMS)[:, 12, 20]
    assert accumulated[0] == pytest.approx((1 + 0.15) / 2)
    np.testing.assert_allclose(accumulated[1:], PARAMS.memory ** np.arange(1, 9) / 2, rtol=1e-4)


def test_the_memory_follows_the_flow():
    saliency = np.zeros((6, *SHAPE), np.float32)
    for t in range(6):
        saliency[t, 8:16, 4 + 3 * t : 12 + 3 * t] = 1
    saliency[3] = 0  # the object stops being seen for a frame
    accumulated = accumulate_saliency(saliency, moving(6, 3), PARAMS)
    assert accumulated[3, 9:15, 14:20].min() > 0.8
    assert accumulated[3, 9:15, :10].max() < 0.1


def test_where_the_flow_is_consistent_neither_way_the_frame_itself_hardly_counts():
    saliency = np.zeros((5, *SHAPE), np.float32)
    saliency[2] = 1
    flows = still(5)
    flows[2, :, ..., 1] = 9.0
    accumulated = accumulate_saliency(saliency, flows, PARAMS)
    reliable = accumulate_saliency(saliency, still(5), PARAMS)
    assert accumulated[2].max() < reliable[2].min() / 2


def test_one_frame_is_its_own_accumulation():
    saliency, flows = random_case(0, 1)
    np.testing.assert_array_equal(accumulate_saliency(saliency, flows, PARAMS), saliency)


def test_frames_beyond_the_memory_need_not_be_seen():
    saliency, _ = random_case(1, 50)
    whole = accumulate_saliency(saliency, still(50), PARAMS)[20:30]
    context = accumulate_saliency(saliency[10:40], still(30), PARAMS)[10:20]
    assert np.abs(whole - context).max() < PARAMS.memory**10
