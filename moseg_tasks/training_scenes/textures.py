"""Textures of the training scenes: noise of many scales, patches, stripes, and surfaces with hardly any detail."""

import cv2
import numpy as np

SIDE = 256
"""Texels along each side; textures repeat beyond it."""


def paint_textures(seed: int, count: int) -> np.ndarray:
    """Paint a pool of random textures.

    Parameters
    ----------
    seed : int
    count : int

    Returns
    -------
    textures : uint8 (count, SIDE, SIDE, 3)
        RGB.
    """
    return np.stack([_paint(np.random.default_rng([seed, index])) for index in range(count)])


def _paint(rng: np.random.Generator) -> np.ndarray:
    palette = _palette(rng)
    mix = _noise(rng, decay=rng.uniform(0.3, 1.1))
    kind = rng.choice(["noise", "patches", "stripes", "flat"], p=[0.4, 0.3, 0.15, 0.15])
    if kind == "patches":
        mix = 0.35 * mix + _patches(rng, int(2 ** rng.uniform(4, 9)))
    elif kind == "stripes":
        mix = 0.35 * mix + _stripes(rng)
    elif kind == "flat":
        mix *= rng.uniform(0.03, 0.15)
    low, high, spot = palette
    share = np.clip(0.5 + 0.5 * mix, 0, 1)[..., None]
    colours = low + (high - low) * share
    spots = np.clip(3 * (_noise(rng, decay=0.8) - rng.uniform(0.6, 2.0)), 0, 1)[..., None]
    grain = 1 + rng.uniform(0, 0.25) * _noise(rng, decay=rng.uniform(0.9, 1.3))[..., None]
    if kind == "flat":
        spots, grain = 0, 1
    return np.clip((colours + (spot - colours) * spots) * grain, 0, 255).astype(np.uint8)


def _palette(rng: np.random.Generator) -> np.ndarray:
    """Draw three colours, float32 (3, 3), mostly of low saturation and of similar hue."""
    hue = (rng.uniform(0, 180) + rng.normal(0, 18, 3)) % 180
    saturation = 255 * rng.beta(1.2, 2.5, 3)
    value = rng.uniform(20, 245, 3)
    hsv = np.stack([hue, saturation, value], axis=-1).astype(np.uint8)
    return cv2.cvtColor(hsv[None], cv2.COLOR_HSV2RGB)[0].astype(np.float32)


def _noise(rng: np.random.Generator, decay: float) -> np.ndarray:
    """Return periodic noise of about unit deviation, whose octaves grow by `decay` from coarse to fine."""
    total, power = np.zeros((SIDE, SIDE), np.float32), 0.0
    for octave in range(2, 9):
        side, gain = 2**octave, decay ** (octave - 2)
        coarse = rng.standard_normal((side, side)).astype(np.float32)
        wrapped = cv2.copyMakeBorder(coarse, 2, 2, 2, 2, cv2.BORDER_WRAP)
        factor = SIDE // side
        fine = cv2.resize(wrapped, None, fx=factor, fy=factor, interpolation=cv2.INTER_LINEAR)
        total += gain * fine[2 * factor : 2 * factor + SIDE, 2 * factor : 2 * factor + SIDE]
        power += gain**2
    return total * np.float32(1.4 / np.sqrt(power))


def _patches(rng: np.random.Generator, count: int) -> np.ndarray:
    """Return flat patches around random points (a Voronoi diagram), each of one random value."""
    seeds = np.full((SIDE, SIDE), 255, np.uint8)
    seeds[rng.integers(0, SIDE, count), rng.integers(0, SIDE, count)] = 0
    _, labels = cv2.distanceTransformWithLabels(seeds, cv2.DIST_L2, 5, labelType=cv2.DIST_LABEL_PIXEL)
    return rng.standard_normal(labels.max() + 1).astype(np.float32)[labels]


def _stripes(rng: np.random.Generator) -> np.ndarray:
    """Return stripes or checks that repeat with the texture."""
    y, x = np.mgrid[:SIDE, :SIDE].astype(np.float32) * np.float32(2 * np.pi / SIDE)
    u, v = rng.integers(-14, 15, 2), rng.integers(-14, 15, 2)
    wave = np.sin(u[0] * x + u[1] * y)
    if rng.random() < 0.5:
        wave = wave * np.sin(v[0] * x + v[1] * y)
    return np.tanh(wave * rng.uniform(1, 6)).astype(np.float32)
