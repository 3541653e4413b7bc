import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import AccumulationParams
from moseg.tasks.saliency import flow_consistency

PARAMS = AccumulationParams()
SHAPE = (20, 32)
PREVIOUS, NEXT = 0, 1


def uniform(to_previous, to_next, num_frames: int) -> list[np.ndarray]:
    flows = np.empty((2, *SHAPE, 2), np.float32)
    flows[PREVIOUS], flows[NEXT] = to_previous, to_next
    return [flows] * num_frames


@settings(max_examples=20, deadline=None)
@given(st.floats(-9, 9, width=32), st.floats(-9, 9, width=32), st.integers(1, 4))
def test_flows_that_are_each_other_s_inverse_are_wholly_consistent(x, y, num_frames):
    np.testing.assert_array_equal(flow_consistency(uniform((-x, -y), (x, y), num_frames), PARAMS), 1)


def test_consistency_falls_with_the_error_as_the_formula_says():
    found = [flow_consistency(uniform((-3 + error, 0), (3, 0), 2), PARAMS)[1, PREVIOUS, 5, 5] for error in range(5)]
    squared = np.arange(5.0)
    allowed = PARAMS.consistency_relative * ((3 - squared) ** 2 + 9) + PARAMS.consistency_absolute
    np.testing.assert_allclose(found, np.exp(-(squared**2) / allowed), rtol=1e-5)
    assert (np.diff(found) < 0).all()


def test_the_way_back_is_read_where_the_flow_leads():
    flows = np.zeros((2, 2, *SHAPE, 2), np.float32)
    flows[0, NEXT, :, :10, 0] = 8.0  # the left part goes right by 8 px
    flows[1, PREVIOUS, :, 8:18, 0] = -8.0
    consistency = flow_consistency(list(flows), PARAMS)
    np.testing.assert_allclose(consistency[0, NEXT, :, :10], 1, atol=1e-6)
    np.testing.assert_allclose(consistency[1, PREVIOUS, :, 8:18], 1, atol=1e-6)
    # What is covered by it in the next frame does not come back; what it uncovers is seen nowhere before.
    assert consistency[0, NEXT, :, 10:18].max() < 1e-3
    assert consistency[1, PREVIOUS, :, :8].max() < 1e-3


def test_each_direction_asks_its_own_neighbour():
    flows = [each.copy() for each in uniform(0, 0, 3)]
    flows[2][PREVIOUS] = 5.0
    consistency = flow_consistency(flows, PARAMS)
    assert consistency[1, NEXT].max() < 1e-3 and consistency[2, PREVIOUS].max() < 1e-3
    assert consistency[1, PREVIOUS].min() == consistency[0].min() == 1


def test_at_the_ends_the_missing_neighbour_is_as_consistent_as_the_one_there_is():
    rng = np.random.default_rng(0)
    consistency = flow_consistency(list(rng.normal(0, 0.3, (4, 2, *SHAPE, 2)).astype(np.float32)), PARAMS)
    np.testing.assert_array_equal(consistency[0, PREVIOUS], consistency[0, NEXT])
    np.testing.assert_array_equal(consistency[3, NEXT], consistency[3, PREVIOUS])
    assert (consistency[1:3, PREVIOUS] != consistency[1:3, NEXT]).any()


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 1000), st.integers(1, 4), st.integers(1, 9), st.integers(1, 9))
def test_reversing_time_swaps_the_directions(seed, num_frames, height, width):
    flows = np.random.default_rng(seed).normal(0, 1, (num_frames, 2, height, width, 2)).astype(np.float32)
    forward = flow_consistency(list(flows), PARAMS)
    assert forward.dtype == np.float32 and forward.shape == (num_frames, 2, height, width)
    assert (forward >= 0).all() and (forward <= 1).all()
    np.testing.assert_array_equal(flow_consistency(list(flows[::-1, ::-1]), PARAMS), forward[::-1, ::-1])


def test_a_single_frame_has_nothing_to_contradict_it():
    np.testing.assert_array_equal(flow_consistency(uniform(7, 7, 1), PARAMS), 1)


@pytest.mark.parametrize("speed", [2.0, 20.0])
def test_a_fast_motion_may_err_in_proportion(speed):
    share = flow_consistency(uniform((-1.05 * speed, 0), (speed, 0), 2), PARAMS)[1, PREVIOUS, 3, 3]
    assert 0.85 < share < 0.98
