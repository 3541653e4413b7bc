"""Shifts of a pattern are found to a few hundredths of a pixel, whatever the brightness."""

import numpy as np
import pytest

from moseg.tasks.screen_graphics.shifts import shifts

NUM_FRAMES = 15
TOLERANCE_PX = 0.03
WAVES = np.array([(0.5, 0.1), (-0.2, 0.6), (0.3, -0.4), (0.1, 0.35)])  # rad/px, xy
PLACES = np.stack(np.meshgrid(np.arange(20.0), np.arange(16.0)), axis=-1).reshape(-1, 2)


def _waves(places):
    """Return levels and gradients of a smooth pattern at places xy, px."""
    phases = places @ WAVES.T + np.arange(len(WAVES))
    return 128 + 25 * np.sin(phases).sum(axis=-1), 25 * np.cos(phases) @ WAVES


def _filmed(moves, gain=1.0, offset=0.0):
    """Return levels uint8 (frame, pixel) of the pattern, shifted by `moves` (frame, 2)."""
    levels = np.stack([_waves(PLACES - move)[0] for move in moves])
    return np.clip(np.rint(gain * levels + offset), 0, 255).astype(np.uint8)


@pytest.fixture
def moves():
    """Return shifts xy of up to half a pixel, of which the median is 0."""
    half = np.random.default_rng(0).uniform(-0.35, 0.35, (NUM_FRAMES // 2, 2))
    return np.concatenate([half, [[0, 0]], -half])


def _find(levels):
    return shifts(levels, _waves(PLACES)[1].astype(np.float32))


def test_known_shifts_are_found(moves):
    assert np.abs(_find(_filmed(moves)) - np.linalg.norm(moves, axis=1)).max() < TOLERANCE_PX


def test_a_pattern_that_stays_has_no_shift():
    assert _find(_filmed(np.zeros((NUM_FRAMES, 2)))).max() < 1e-6


def test_brightness_and_contrast_may_change(moves):
    rng = np.random.default_rng(1)
    gains, offsets = (rng.uniform(*span, (NUM_FRAMES, 1)) for span in ((0.95, 1.05), (-15, 15)))
    found = _find(_filmed(moves, gains, offsets))
    assert np.abs(found - np.linalg.norm(moves, axis=1)).max() < 2 * TOLERANCE_PX


def test_a_change_of_brightness_and_contrast_is_no_shift():
    rng = np.random.default_rng(1)
    gains, offsets = (rng.uniform(*span, (NUM_FRAMES, 1)) for span in ((0.8, 1.1), (-15, 15)))
    assert _find(_filmed(np.zeros((NUM_FRAMES, 2)), gains, offsets)).max() < TOLERANCE_PX


def test_a_tenth_of_the_pixels_may_show_something_else(moves):
    rng = np.random.default_rng(2)
    levels = _filmed(moves)
    for frame in levels:
        other = rng.choice(len(PLACES), len(PLACES) // 10, replace=False)
        frame[other] = rng.integers(0, 256, len(other))
    assert np.abs(_find(levels) - np.linalg.norm(moves, axis=1)).max() < 2 * TOLERANCE_PX


@pytest.mark.parametrize("across", [(1, 0), (0, 1), (0.6, 0.8)])
def test_along_a_line_no_shift_can_be_seen(across):
    slope = np.cos(0.5 * PLACES @ across)
    levels = np.rint(128 + 50 * np.sin(0.5 * PLACES @ across)).astype(np.uint8)
    assert shifts(np.stack([levels] * NUM_FRAMES), np.outer(25 * slope, across).astype(np.float32)) is None
