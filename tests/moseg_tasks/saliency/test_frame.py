import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.schemas.errors import InputError
from moseg.schemas.parameters import SaliencyParams
from moseg.tasks.frame_grid import grid_shape, resample
from moseg.tasks.saliency import BackgroundChoice, estimate_saliency

SHAPE = (96, 160)
PARAMS = SaliencyParams(working_side=max(SHAPE))
BACKGROUND = np.array([2.0, 1.0], np.float32)
OBJECT = (slice(36, 64), slice(60, 100))


def texture(seed: int) -> np.ndarray:
    noise = np.random.default_rng(seed).integers(0, 256, (*SHAPE, 3), np.uint8)
    return cv2.GaussianBlur(noise, (0, 0), 1.0)


def uniform_flow(object_motion=(0.0, 0.0)) -> np.ndarray:
    flow = np.tile(BACKGROUND, (*SHAPE, 1))
    flow[OBJECT] += np.array(object_motion, np.float32)
    return flow


FRAME = texture(0)
MOVED = np.roll(FRAME, (1, 2), axis=(0, 1))  # as seen after the background's motion
OTHER = MOVED.copy()
OTHER[OBJECT] = texture(1)[OBJECT]


def test_a_square_that_moves_against_an_affine_background_is_salient():
    saliency = estimate_saliency(FRAME, None, OTHER, None, uniform_flow((3.0, 0.0)), PARAMS).saliency
    assert saliency.dtype == np.float16 and saliency.shape == SHAPE
    assert saliency[40:60, 64:96].min() > 0.9
    outside = np.ones(SHAPE, bool)
    outside[26:74, 50:110] = False
    assert saliency[outside].max() < 0.05


@pytest.mark.parametrize("side", [80, 240])
def test_frames_on_the_working_grid_give_what_the_frames_give(side):
    params = SaliencyParams(working_side=side)
    flow = uniform_flow((3.0, 0.0))
    resampled = [resample(image, grid_shape(SHAPE, side)) for image in (FRAME, OTHER)]
    given = estimate_saliency(FRAME, None, OTHER, None, flow, params)
    found = estimate_saliency(resampled[0], None, resampled[1], None, flow, params, size=SHAPE)
    assert given.saliency.shape == (side * 3 // 5, side) and given.saliency.max() > 0.9
    for name in ("saliency", "strict_saliency", "flows", "residual_flows"):
        assert np.array_equal(getattr(given, name), getattr(found, name))


def test_the_camera_s_own_motion_is_not_salient():
    assert estimate_saliency(FRAME, None, MOVED, None, uniform_flow(), PARAMS).saliency.max() < 0.01


def test_zero_flow_is_not_salient():
    still = np.zeros((*SHAPE, 2), np.float32)
    assert estimate_saliency(FRAME, FRAME, FRAME, still, still, PARAMS).saliency.max() < 1e-6


def test_flow_noise_under_the_floor_stays_below_the_threshold_of_objects():
    noise = np.random.default_rng(0).normal(0, 0.15, (*SHAPE, 2)).astype(np.float32)
    saliency = estimate_saliency(FRAME, None, texture(1), None, uniform_flow() + noise, PARAMS).saliency
    assert np.mean(saliency > 0.6) < 0.001


def test_motion_that_the_colours_deny_is_gated_away():
    denied = estimate_saliency(FRAME, None, MOVED, None, uniform_flow((3.0, 0.0)), PARAMS).saliency
    assert denied[46:54, 74:86].max() < 0.05


def test_an_error_in_one_time_direction_only_is_an_occlusion():
    occluded, clean = uniform_flow((3.0, 0.0)), -uniform_flow()
    previous = np.roll(FRAME, (-1, -2), axis=(0, 1))
    assert estimate_saliency(FRAME, previous, OTHER, clean, occluded, PARAMS).saliency.max() < 0.05


@pytest.mark.parametrize("reversed_time", [False, True])
def test_a_residual_in_one_time_direction_only_is_none_whatever_the_colours_say(reversed_time):
    order = slice(None, None, -1 if reversed_time else 1)
    images, flows = (texture(2), texture(1))[order], (-uniform_flow(), uniform_flow((3.0, 0.0)))[order]
    assert estimate_saliency(FRAME, *images, *flows, PARAMS).saliency.max() < 0.05


@pytest.mark.parametrize("reversed_time", [False, True])
def test_colours_that_the_background_explains_in_one_time_direction_deny_motion(reversed_time):
    order = slice(None, None, -1 if reversed_time else 1)
    images = (np.roll(FRAME, (-1, -2), axis=(0, 1)), texture(1))[order]
    flows = (-uniform_flow((3.0, 0.0)), uniform_flow((3.0, 0.0)))[order]
    saliency = estimate_saliency(FRAME, *images, *flows, PARAMS).saliency
    assert saliency[46:54, 74:86].max() < 0.05


def test_a_colour_error_between_both_gates_is_salient_but_not_strictly():
    fainter = cv2.addWeighted(MOVED, 0.85, OTHER, 0.15, 0)
    result = estimate_saliency(FRAME, None, fainter, None, uniform_flow((3.0, 0.0)), PARAMS)
    inside = (slice(44, 56), slice(70, 90))
    assert np.median(result.saliency[inside]) > 2 * np.median(result.strict_saliency[inside]) > 0
    assert (result.strict_saliency <= result.saliency).all()
    alike = PARAMS.model_copy(update={"strict_gate_error": PARAMS.gate_error})
    equal = estimate_saliency(FRAME, None, fainter, None, uniform_flow((3.0, 0.0)), alike)
    np.testing.assert_array_equal(equal.strict_saliency, result.saliency)


def test_the_residual_flow_is_what_moves_on_its_own():
    flows = -uniform_flow((2.0, -1.0)), uniform_flow((3.0, 0.0))
    result = estimate_saliency(FRAME, OTHER, OTHER, *flows, PARAMS)
    assert result.residual_flows.dtype == np.float16
    expected = np.zeros((2, *SHAPE, 2))
    expected[0][OBJECT], expected[1][OBJECT] = (-2.0, 1.0), (3.0, 0.0)
    np.testing.assert_allclose(result.residual_flows, expected, atol=0.02)


def test_time_reversal_leaves_the_saliency():
    rng = np.random.default_rng(0)
    flows = [uniform_flow((3.0, 1.0)) + rng.normal(0, 0.2, (*SHAPE, 2)).astype(np.float32) for _ in range(2)]
    forward = estimate_saliency(FRAME, texture(2), texture(1), flows[0], flows[1], PARAMS)
    reverse = estimate_saliency(FRAME, texture(1), texture(2), flows[1], flows[0], PARAMS)
    np.testing.assert_array_equal(forward.saliency, reverse.saliency)
    np.testing.assert_array_equal(forward.strict_saliency, reverse.strict_saliency)
    np.testing.assert_array_equal(forward.flows, reverse.flows[::-1])
    np.testing.assert_array_equal(forward.residual_flows, reverse.residual_flows[::-1])


def _copied_to(array: np.ndarray, offset: int) -> np.ndarray:
    """A copy that begins `offset` bytes after a multiple of 64."""
    memory = np.empty(array.nbytes + 128, np.uint8)
    start = -memory.ctypes.data % 64 + offset
    copy = memory[start : start + array.nbytes].view(array.dtype).reshape(array.shape)
    copy[:] = array
    return copy


@pytest.mark.parametrize("model", ["layers", "rigid"])
def test_the_bytes_do_not_depend_on_where_the_arrays_lie(model):
    choice = BackgroundChoice(model=model)
    noise = np.random.default_rng(0).normal(0, 0.2, (*SHAPE, 2)).astype(np.float32)
    flow = uniform_flow((3.0, 1.0)) + noise
    found = {
        estimate_saliency(FRAME, None, OTHER, None, _copied_to(flow, offset), PARAMS, choice).saliency.tobytes()
        for offset in (0, 4, 8, 16, 20, 32, 36, 48)
    }
    assert len(found) == 1


def test_the_absent_direction_at_an_end_has_zero_flow():
    flows = estimate_saliency(FRAME, None, OTHER, None, uniform_flow(), PARAMS).flows
    assert flows.shape == (2, *SHAPE, 2) and flows.dtype == np.float16
    assert not flows[0].any() and np.array_equal(flows[1], uniform_flow())


def test_a_single_frame_has_no_saliency():
    result = estimate_saliency(FRAME, None, None, None, None, PARAMS)
    assert not any(array.any() for array in result[:4])
    assert result.first_layers == (None, None)
    assert result.strict_saliency.shape == SHAPE and result.residual_flows.shape == (2, *SHAPE, 2)


@settings(max_examples=15, deadline=None)
@given(st.integers(1, 12), st.integers(1, 12), st.integers(0, 2**31))
def test_tiny_frames_of_any_content_give_saliency_in_range(height, width, seed):
    rng = np.random.default_rng(seed)
    frame, other = rng.integers(0, 256, (2, height, width, 3), np.uint8)
    flow = rng.normal(0, 3, (height, width, 2)).astype(np.float32)
    saliency = estimate_saliency(frame, other, None, flow, None, PARAMS).saliency
    assert saliency.shape == (2 * height, 2 * width) and (saliency >= 0).all() and (saliency <= 1).all()


def test_a_large_frame_is_worked_on_at_the_working_size():
    big = np.repeat(np.repeat(FRAME, 4, axis=0), 4, axis=1)
    flow = np.ones((*big.shape[:2], 2), np.float32)
    result = estimate_saliency(big, None, big, None, flow, SaliencyParams())
    assert result.saliency.shape == (256, 427) and result.flows.shape == (2, 256, 427, 2)
    np.testing.assert_allclose(result.flows[1, ..., 0], 427 / 640, rtol=2**-11)


def test_flow_on_a_coarser_grid_shows_the_same_object():
    flow = uniform_flow((3.0, 0.0))
    coarse = cv2.resize(flow, (SHAPE[1] // 2, SHAPE[0] // 2), interpolation=cv2.INTER_AREA)
    full, reduced = (estimate_saliency(FRAME, None, OTHER, None, each, PARAMS) for each in (flow, coarse))
    assert reduced.saliency.shape == SHAPE
    assert np.abs(full.saliency.astype(float) - reduced.saliency).mean() < 0.02
    assert reduced.saliency[OBJECT].mean() > 0.8


@pytest.mark.parametrize(
    ("other", "flow"), [(FRAME, None), (None, uniform_flow()), (FRAME[1:], uniform_flow()), (FRAME, uniform_flow()[1:])]
)
def test_a_neighbour_that_does_not_fit_the_frame_is_an_input_error(other, flow):
    with pytest.raises(InputError, match="neighbour"):
        estimate_saliency(FRAME, other, None, flow, None, PARAMS)
