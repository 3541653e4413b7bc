import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from moseg.tasks.proposals.guided_filter import apply_coefficients, guided_coefficients

SHAPE = (40, 56)
RADIUS, SMOOTHNESS = 3, 1e-4


def coloured(seed: int, shape=SHAPE) -> np.ndarray:
    return np.random.default_rng(seed).random((*shape, 3), np.float32)


def filtered(guide, wanted, radius=RADIUS, smoothness=SMOOTHNESS) -> np.ndarray:
    return apply_coefficients(guide, *guided_coefficients(guide, wanted, radius, smoothness))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 1000), st.tuples(*[st.floats(-2, 2)] * 3), st.floats(-1, 1))
def test_a_map_affine_in_colour_is_reproduced(seed, slope, offset):
    guide = coloured(seed)
    wanted = (guide @ np.float32(slope) + np.float32(offset)).astype(np.float32)
    np.testing.assert_allclose(filtered(guide, wanted), wanted, atol=0.02)
    found, constant = guided_coefficients(guide, wanted, RADIUS, 1e-6)
    np.testing.assert_allclose(found, np.broadcast_to(np.float32(slope), guide.shape), atol=0.01)
    np.testing.assert_allclose(constant, offset, atol=0.02)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 1000), st.floats(0, 1, width=32), st.integers(1, 12), st.integers(1, 12))
def test_a_constant_map_stays_constant_on_frames_of_any_size(seed, level, height, width):
    guide = coloured(seed, (height, width))
    slope, offset = guided_coefficients(guide, np.full((height, width), level, np.float32), RADIUS, SMOOTHNESS)
    assert slope.shape == (height, width, 3) and offset.shape == (height, width)
    assert slope.dtype == offset.dtype == np.float32
    np.testing.assert_allclose(apply_coefficients(guide, slope, offset), level, atol=1e-3)


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 1000), st.floats(-3, 3), st.floats(-1, 1))
def test_the_filter_is_linear_in_the_map(seed, factor, shift):
    guide, wanted = coloured(seed), coloured(seed + 1)[..., 0]
    plain = filtered(guide, wanted)
    np.testing.assert_allclose(
        filtered(guide, (np.float32(factor) * wanted + np.float32(shift)).astype(np.float32)),
        factor * plain + shift,
        atol=2e-3,
    )


def test_an_image_without_colour_only_blurs():
    guide, wanted = np.full((*SHAPE, 3), 0.4, np.float32), coloured(0)[..., 0]
    window = (2 * RADIUS + 1,) * 2
    twice = cv2.blur(cv2.blur(wanted, window, borderType=cv2.BORDER_REFLECT), window, borderType=cv2.BORDER_REFLECT)
    np.testing.assert_allclose(filtered(guide, wanted), twice, atol=1e-3)


def test_it_is_least_squares_under_a_penalty_in_every_window():
    guide, wanted = coloured(2, (7, 7)).astype(np.float32), coloured(3, (7, 7))[..., 0]
    # A window of the whole image in its middle: one model, before the models of windows are averaged.
    colours, values = guide.reshape(-1, 3).astype(np.float64), wanted.ravel().astype(np.float64)
    centred = colours - colours.mean(axis=0)
    smoothness = 0.05
    expected = np.linalg.solve(centred.T @ centred / 49 + smoothness * np.eye(3), centred.T @ values / 49)
    slope, _ = guided_coefficients(np.tile(guide, (5, 5, 1)), np.tile(wanted, (5, 5)), 3, smoothness)
    np.testing.assert_allclose(slope[17, 17], expected, rtol=1e-3)


@pytest.mark.parametrize("is_grey", [False, True])
def test_an_outline_that_is_off_snaps_to_the_edge_of_the_image(is_grey):
    guide = np.empty((*SHAPE, 3), np.float32)
    guide[:, :30], guide[:, 30:] = (0.2, 0.2, 0.2) if is_grey else (0.2, 0.3, 0.6), (0.6, 0.6, 0.6)
    wanted = np.zeros(SHAPE, np.float32)
    wanted[:, 29:] = 1
    np.testing.assert_array_equal(filtered(guide, wanted)[6:-6] > 0.5, np.broadcast_to(np.arange(56) >= 30, (28, 56)))


def test_coefficients_of_a_coarse_grid_find_the_edge_at_full_size():
    full = np.full((160, 224, 3), 0.2, np.float32)
    full[:, 117:] = (0.7, 0.5, 0.3)  # 29 cells and a quarter
    guide = cv2.resize(full, SHAPE[::-1], interpolation=cv2.INTER_AREA)
    wanted = np.zeros(SHAPE, np.float32)
    wanted[:, 29:] = 1
    coarse = cv2.resize(wanted, (224, 160), interpolation=cv2.INTER_LINEAR)[80] > 0.5
    found = apply_coefficients(full, *guided_coefficients(guide, wanted, RADIUS, SMOOTHNESS))
    assert found.shape == (160, 224) and found.dtype == np.float32
    assert np.flatnonzero(found[80] > 0.5)[0] == 117 != np.flatnonzero(coarse)[0]


def test_coefficients_change_without_steps_when_they_are_enlarged():
    offset = np.tile(np.arange(8, dtype=np.float32), (4, 1))
    slope = np.repeat(offset[..., None], 3, axis=2)
    for guide in (np.zeros((16, 32, 3), np.float32), np.ones((16, 32, 3), np.float32)):
        found = apply_coefficients(guide, slope, offset)
        along = np.clip((np.arange(32) + 0.5) / 4 - 0.5, 0, 7)
        np.testing.assert_allclose(found, np.tile((1 + guide[0, 0].sum()) * along, (16, 1)), atol=1e-5)


def test_inputs_are_not_modified():
    guide, wanted = coloured(5), coloured(6)[..., 0].copy()
    before = guide.copy(), wanted.copy()
    filtered(guide, wanted)
    assert np.array_equal(guide, before[0]) and np.array_equal(wanted, before[1])
