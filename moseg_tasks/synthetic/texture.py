"""Textures of several octaves of noise, and their filtered look-up through mip maps."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import Field

from moseg.schemas.frozen import Frozen

SIZE = 512
"""Texels along each side of a texture, a power of two; textures repeat beyond it."""
COARSEST = 8
"""Texels along each side of the coarsest mip level."""

Color = tuple[float, float, float]


class Texture(Frozen):
    """A periodic pattern.

    ``blotches`` is noise alone; ``tiles`` adds mortar lines in running bond, ``planks`` adds long boards and
    ``windows`` adds rows of dark panes.
    """

    palette: tuple[Color, Color, Color] = Field(description="two ground colours and the colour of spots, RGB 0..255")
    texel: float = Field(0.012, gt=0, description="side of one texel, m")
    pattern: Literal["blotches", "tiles", "planks", "windows"] = "blotches"
    contrast: float = Field(0.22, ge=0, description="relative brightness of the finest detail, standard deviation")
    seed: int = Field(ge=0, description="seed of the noise")


class MipMap(NamedTuple):
    """A texture at halving resolutions.

    Attributes
    ----------
    texels : float32 (sum of squared sides, 3)
        RGB, levels one after the other, rows first.
    offsets : int64 (levels,)
        Index of each level's first texel.
    """

    texels: np.ndarray
    offsets: np.ndarray


def paint_texture(texture: Texture) -> MipMap:
    """Paint a texture and halve it down to 8 x 8 texels."""
    rng = np.random.default_rng(texture.seed)
    ground, spot, detail = (_noise(rng) for _ in range(3))
    mix, spots = np.clip(0.5 + 0.5 * ground, 0.0, 1.0), np.clip(3.0 * (spot - 0.8), 0.0, 1.0)
    brightness = np.maximum(1.0 + texture.contrast * detail, 0.1)
    if texture.pattern != "blotches":
        brightness *= _panes(rng) if texture.pattern == "windows" else _joints(rng, texture.pattern)
    level = np.empty((SIZE, SIZE, 3), np.float32)
    for channel, (first, second, third) in enumerate(zip(*texture.palette, strict=True)):
        color = first + (second - first) * mix
        level[..., channel] = np.clip((color + (third - color) * spots) * brightness, 0.0, 255.0)
    levels = [level]
    while len(level) > COARSEST:
        level = (level[::2, ::2] + level[1::2, ::2] + level[::2, 1::2] + level[1::2, 1::2]) * np.float32(0.25)
        levels.append(level)
    sizes = [level.shape[0] ** 2 for level in levels]
    return MipMap(np.concatenate([level.reshape(-1, 3) for level in levels]), np.cumsum([0, *sizes[:-1]]))


def sample_texture(mipmap: MipMap, u: np.ndarray, v: np.ndarray, footprint: np.ndarray) -> np.ndarray:
    """Sample a texture by trilinear interpolation.

    Parameters
    ----------
    mipmap : MipMap
    u, v : float64 (N,)
        Texels of the finest level.
    footprint : float64 (N,)
        Texels of the finest level that one pixel covers along an axis.

    Returns
    -------
    float32 (N, 3)
        RGB.
    """
    mantissa, exponent = np.frexp(footprint)
    # log2, linear between powers of two: np.log2 is not rounded equally on all processors.
    level = np.clip(exponent - 2 + 2.0 * mantissa, 0.0, len(mipmap.offsets) - 1.001)
    finer = level.astype(np.int64)
    weight = (level - finer).astype(np.float32)[:, None]
    fine = _bilinear(mipmap, u, v, finer)
    return fine + (_bilinear(mipmap, u, v, finer + 1) - fine) * weight


def _bilinear(mipmap: MipMap, u: np.ndarray, v: np.ndarray, level: np.ndarray) -> np.ndarray:
    side = SIZE >> level
    scale = 1.0 / (1 << level)
    u, v = u * scale - 0.5, v * scale - 0.5
    column, row = np.floor(u), np.floor(v)
    right, down = (u - column).astype(np.float32)[:, None], (v - row).astype(np.float32)[:, None]
    column, row = column.astype(np.int64), row.astype(np.int64)
    # Sides are powers of two, so masking wraps, negative coordinates included.
    column0, column1 = column & (side - 1), (column + 1) & (side - 1)
    row0 = mipmap.offsets[level] + (row & (side - 1)) * side
    row1 = mipmap.offsets[level] + ((row + 1) & (side - 1)) * side
    upper_left, upper_right = mipmap.texels.take(row0 + column0, axis=0), mipmap.texels.take(row0 + column1, axis=0)
    lower_left, lower_right = mipmap.texels.take(row1 + column0, axis=0), mipmap.texels.take(row1 + column1, axis=0)
    upper = upper_left + (upper_right - upper_left) * right
    lower = lower_left + (lower_right - lower_left) * right
    return upper + (lower - upper) * down


def _noise(rng: np.random.Generator) -> np.ndarray:
    """Return periodic noise with equal energy in each octave, of about zero mean and unit variance."""
    total, octaves = np.zeros((COARSEST, COARSEST)), 0
    while len(total) < SIZE:
        total = _double(_double(total + rng.random(total.shape) - 0.5, 0), 1)
        octaves += 1
    # A uniform deviate on (-1/2, 1/2) has variance 1/12, of which repeated doubling keeps about a third.
    return total * np.sqrt(36.0 / octaves)


def _double(grid: np.ndarray, axis: int) -> np.ndarray:
    """Double the samples of a periodic grid along an axis, by Chaikin's corner cutting (quadratic B-splines)."""
    halves = [0.75 * grid + 0.25 * np.roll(grid, step, axis) for step in (1, -1)]
    shape = [size * (1 + (index == axis)) for index, size in enumerate(grid.shape)]
    return np.stack(halves, axis + 1).reshape(shape)


def _joints(rng: np.random.Generator, pattern: str) -> np.ndarray:
    """Return the brightness factor of tiles or planks: dark joints, and a different shade for each piece."""
    height, width = {"tiles": (32, 64), "planks": (32, 256)}[pattern]
    rows, columns = np.mgrid[:SIZE, :SIZE]
    course = rows // height
    shifted = (columns + course * (width // 2)) % SIZE
    piece = rng.random((SIZE // height, SIZE // width))[course, shifted // width]
    joint = (rows % height < 3) | (shifted % width < 3)
    return np.where(joint, 0.45, 0.75 + 0.5 * piece)


def _panes(rng: np.random.Generator) -> np.ndarray:
    """Return the brightness factor of a wall with a pane in each square of 64 texels, each of a different darkness."""
    rows, columns = np.mgrid[:SIZE, :SIZE]
    pane = rng.random((SIZE // 64, SIZE // 64))[rows // 64, columns // 64]
    is_pane = (abs(rows % 64 - 31.5) < 18) & (abs(columns % 64 - 31.5) < 13)
    is_bar = (columns % 64 // 2 == 16) | (rows % 64 // 2 == 13)
    return np.where(is_pane & ~is_bar, 0.25 + 0.35 * pane, 1.0)
