import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.parameters import OwnMotionParams
from moseg.tasks.saliency import own_motion_misfit
from moseg.tasks.saliency.grid import pixel_grid

PARAMS = OwnMotionParams()
SHAPE = (96, 128)
OBJECT = (slice(28, 76), slice(40, 92))
NOTHING = np.zeros((*SHAPE, 2), np.float32)


def weight_of_object() -> np.ndarray:
    weight = np.zeros(SHAPE, np.float32)
    weight[OBJECT] = 1
    return weight


def moved(rotation: float, expansion: float, shift) -> np.ndarray:
    """Flow of an object that shifts, turns by an angle (rad) and grows about its own middle; zero around it."""
    turn = (1 + expansion) * np.array([[np.cos(rotation), -np.sin(rotation)], [np.sin(rotation), np.cos(rotation)]])
    flow = NOTHING.copy()
    flow[OBJECT] = ((pixel_grid(SHAPE) - np.float32([66, 52])) @ (turn - np.eye(2)).T + shift)[OBJECT]
    return flow


def noise(seed: int, size: float) -> np.ndarray:
    return np.random.default_rng(seed).normal(0, size, (*SHAPE, 2)).astype(np.float32)


@settings(max_examples=20, deadline=None)
@given(st.floats(-0.08, 0.08), st.floats(-0.05, 0.05), st.tuples(st.floats(-8, 8), st.floats(-8, 8)), st.booleans())
def test_an_object_that_shifts_turns_and_grows_has_no_misfit(rotation, expansion, shift, at_the_end):
    flow = moved(rotation, expansion, shift)
    misfit = own_motion_misfit((-flow, None if at_the_end else flow), weight_of_object(), PARAMS)
    assert misfit.dtype == np.float32 and misfit.shape == SHAPE
    assert misfit[OBJECT].max() < 0.25


def test_pixels_that_do_not_move_with_the_object_misfit():
    misfit = own_motion_misfit((None, moved(0.02, 0, (5, 0))), weight_of_object(), PARAMS)
    outside = np.ones(SHAPE, bool)
    outside[OBJECT] = False
    assert misfit[outside].min() > 5


def test_the_misfit_is_the_log_of_the_squared_deviation_in_spreads():
    flow = moved(0, 0, (4.0, 0.0))
    flow[40:44, 60:64] += np.float32([0.0, 1.0])
    misfit = own_motion_misfit((None, flow), weight_of_object(), PARAMS)
    np.testing.assert_allclose(misfit[40:44, 60:64], np.log1p((1 / PARAMS.spread_floor) ** 2), rtol=0.02)


def test_a_texture_that_moves_incoherently_misfits_beside_an_object_that_does_not():
    flow = moved(0.03, 0, (4.0, -2.0))
    water = (slice(80, 96), slice(0, 128))
    flow[water] = noise(0, 3.0)[water]
    weight = weight_of_object()
    weight[water] = 0.2
    misfit = own_motion_misfit((None, flow), weight, PARAMS)
    assert np.median(misfit[water]) > 4 > 0.3 > misfit[OBJECT].max()


def test_outliers_within_the_object_do_not_bend_its_motion():
    flow = moved(0.03, 0.02, (4.0, -2.0))
    flow[50:76, 70:92] += np.float32([6.0, 6.0])  # under a quarter of it
    misfit = own_motion_misfit((None, flow), weight_of_object(), PARAMS)
    assert misfit[30:48, 42:88].max() < 0.25 and misfit[54:72, 74:88].min() > 3


def test_limbs_widen_the_spread_so_that_they_are_no_outliers():
    flow = moved(0, 0, (4.0, 0.0)) + noise(1, 0.8) * weight_of_object()[..., None]
    assert np.median(own_motion_misfit((None, flow), weight_of_object(), PARAMS)[OBJECT]) < 1


@settings(max_examples=15, deadline=None)
@given(st.floats(1, 8), st.integers(0, 1000))
def test_motion_k_times_as_fast_misfits_the_same(factor, seed):
    flow = moved(0.05, 0, (3.0, 1.0)) + noise(seed, 0.6)
    slow = own_motion_misfit((None, flow), weight_of_object(), PARAMS)
    fast = own_motion_misfit((None, np.float32(factor) * flow), weight_of_object(), PARAMS)
    np.testing.assert_allclose(fast, slow, rtol=1e-3, atol=1e-3)


def test_motion_common_to_all_does_not_count():
    flow = moved(0.05, 0, (3.0, 1.0)) + noise(2, 0.6)
    shifted = flow + np.float32([7.0, -4.0])
    there, here = (own_motion_misfit((None, each), weight_of_object(), PARAMS) for each in (shifted, flow))
    np.testing.assert_allclose(there, here, rtol=1e-3, atol=1e-3)


@pytest.mark.parametrize("swapped", [False, True])
def test_the_direction_that_fits_better_counts(swapped):
    broken = moved(0, 0, (4.0, 0.0))
    broken[40:60, 50:70] += np.float32([0.0, 5.0])
    flows = (moved(0, 0, (-4.0, 0.0)), broken)
    misfit = own_motion_misfit(flows[::-1] if swapped else flows, weight_of_object(), PARAMS)
    assert misfit[OBJECT].max() < 0.05


@pytest.mark.parametrize(
    ("flows", "weight"),
    [
        ((None, None), weight_of_object()),
        ((noise(0, 3), noise(1, 3)), np.zeros(SHAPE, np.float32)),
        ((noise(0, 3), None), np.full(SHAPE, 1e-3, np.float32)),
    ],
)
def test_no_salient_pixels_or_no_flow_give_no_misfit(flows, weight):
    misfit = own_motion_misfit(flows, weight, PARAMS)
    assert misfit.shape == SHAPE and misfit.dtype == np.float32 and not misfit.any()


def test_an_object_a_few_pixels_small_is_not_enough_to_fit_to():
    weight = np.zeros(SHAPE, np.float32)
    weight[40:52, 40:52] = 1  # nine places of the grid
    assert not own_motion_misfit((None, moved(0, 0, (4.0, 0.0))), weight, PARAMS).any()
    few = PARAMS.model_copy(update={"least_weight": 8.0})
    assert own_motion_misfit((None, moved(0, 0, (4.0, 0.0))), weight, few).any()


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 40), st.integers(1, 40), st.integers(0, 1000), st.floats(0, 200))
def test_any_flow_and_weight_give_finite_misfits(height, width, seed, speed):
    rng = np.random.default_rng(seed)
    flows = rng.normal(0, speed, (2, height, width, 2)).astype(np.float32)
    weight = rng.random((height, width), np.float32) ** 2
    before = flows.copy(), weight.copy()
    misfit = own_motion_misfit((flows[0], flows[1]), weight, PARAMS)
    assert misfit.shape == (height, width) and np.isfinite(misfit).all() and (misfit >= 0).all()
    assert np.array_equal(flows, before[0]) and np.array_equal(weight, before[1])


def test_a_region_apart_is_compared_with_its_own_motion_and_not_with_that_of_a_larger_one():
    flow, weight = moved(0.0, 0.0, (2.0, 0.0)), weight_of_object()
    small = (slice(6, 16), slice(100, 112))
    flow[small], weight[small] = (-1.5, 0.5), 0.2
    assert own_motion_misfit((None, flow), weight, PARAMS)[small].max() < 1
    alone = PARAMS.model_copy(update={"regions": 0})
    assert own_motion_misfit((None, flow), weight, alone)[small].min() > 5


def test_a_region_apart_whose_motion_is_not_uniform_keeps_its_misfit():
    flow, weight = moved(0.0, 0.0, (2.0, 0.0)), weight_of_object()
    water = (slice(4, 20), slice(96, 124))
    flow[water], weight[water] = noise(3, 2.0)[water], 1
    assert np.median(own_motion_misfit((None, flow), weight, PARAMS)[water]) > 3


def object_and_region(region):
    """Return the flow of an object, and of a region apart that moves the other way, and their weights."""
    flow, weight = moved(0.0, 0.0, (2.0, 0.0)), weight_of_object()
    flow[region], weight[region] = (-2, 0), 1
    return flow, weight


def test_a_part_of_a_region_apart_may_move_with_the_larger_one():
    region = (slice(4, 20), slice(96, 124))
    flow, weight = object_and_region(region)
    flow[4:20, 96:102] = (2, 0)
    assert own_motion_misfit((None, flow), weight, PARAMS)[region].max() < 1


@pytest.mark.parametrize(("share", "is_small"), [(0.009, False), (0.011, True)])
def test_a_region_apart_below_a_share_of_the_frame_keeps_its_misfit(share, is_small):
    region = (slice(6, 16), slice(100, 112))
    flow, weight = object_and_region(region)
    misfit = own_motion_misfit((None, flow), weight, PARAMS.model_copy(update={"region_area": share}))
    assert (misfit[region].min() > 5) == is_small
