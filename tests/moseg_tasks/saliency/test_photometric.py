import numpy as np
import pytest

from moseg.tasks.saliency.photometric import blur_error, colour_error, photometric_gate

SHAPE = (20, 30)
RNG = np.random.default_rng(0)
FRAME = RNG.integers(0, 256, (*SHAPE, 3)).astype(np.float32)


def uniform(x: float, y: float) -> np.ndarray:
    return np.tile(np.float32([x, y]), (*SHAPE, 1))


def test_the_correct_flow_gives_no_error_inside_the_frame():
    moved = np.roll(FRAME, (2, 3), axis=(0, 1))
    error = colour_error(FRAME, moved, uniform(3, 2))
    assert error.shape == SHAPE and error.dtype == np.float32
    np.testing.assert_allclose(error[:-2, :-3], 0, atol=1e-3)
    assert colour_error(FRAME, moved, uniform(0, 0)).mean() > 50


def test_the_error_is_the_root_mean_square_over_colour():
    other = FRAME.copy()
    other[4, 5] += np.float32([3.0, -4.0, 12.0])
    error = colour_error(FRAME, other, uniform(0, 0))
    assert error[4, 5] == pytest.approx(13 / np.sqrt(3), rel=1e-5)
    assert np.count_nonzero(error) == 1


def test_a_blur_keeps_the_mean_of_what_it_spreads():
    error = np.zeros((61, 61), np.float32)
    error[30, 30] = 100
    blurred = blur_error(error, 3.0)
    assert blurred.sum() == pytest.approx(100, rel=1e-3)
    x = np.arange(61) - 30
    assert np.sqrt((blurred.sum(axis=0) * x**2).sum() / 100) == pytest.approx(3.0, rel=0.05)
    np.testing.assert_allclose(blur_error(np.full(SHAPE, 7.0, np.float32), 5.8), 7, rtol=1e-5)


def test_the_gate_opens_with_the_error_and_is_open_to_1_less_1_e_at_its_scale():
    gate = photometric_gate(np.float32([[0, 1, 2.5, 5, 1e3]]), 2.5)
    np.testing.assert_allclose(gate, [1 - np.exp(-np.square([0, 0.4, 1, 2, 400]))], atol=1e-6)
    assert (np.diff(gate) > 0).all()


def test_a_stricter_gate_lets_less_through():
    error = RNG.uniform(0, 20, SHAPE).astype(np.float32)
    assert (photometric_gate(error, 6.0) < photometric_gate(error, 2.5)).mean() > 0.9
