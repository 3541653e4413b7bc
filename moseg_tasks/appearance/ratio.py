"""Log ratio of the colours and textures of what moves to those of the background."""

from collections.abc import Sequence

import numpy as np
from scipy import ndimage

from moseg.schemas.parameters import AppearanceParams
from moseg.tasks.appearance.histograms import ColourCount, histogram_shape


def pool_sections(counts: Sequence[ColourCount], centres: Sequence[float], at: float, memory: float) -> ColourCount:
    """Add the counts of sections, each weighted by `memory` to the power of the frames between its centre and `at`.

    Parameters
    ----------
    counts : sequence of ColourCount
    centres : sequence of float
        Middle frame of each.
    at : float
        Frame for which the counts are pooled.
    memory : float
        0..1.
    """
    weights = [memory ** abs(centre - at) for centre in centres]
    sides = zip(*counts, strict=True)
    return ColourCount(*(sum(w * part for w, part in zip(weights, side, strict=True)) for side in sides))


def colour_ratio(count: ColourCount, params: AppearanceParams) -> np.ndarray:
    """Return the log ratio of a colour and texture in what moves to those in the background, float32 (bin,).

    It is log(share of a colour in what moves / its share in the background), limited to +-`clip`, plus the same of the
    texture among the pixels of this colour, limited again. It shrinks with the weight of moving pixels, and is 0
    throughout if none moves or all move.
    """
    if count.weight <= 0 or count.moving.sum() <= 0 or count.static.sum() <= 0:
        return np.zeros(len(count.moving), np.float32)
    moving, static = (_colour_shares(side, params) for side in (count.moving, count.static))
    ratio = np.log((moving + params.floor) / (static + params.floor)).clip(-params.clip, params.clip)[..., None]
    ratio = (ratio + _texture_ratio(count, params)).clip(-params.clip, params.clip).ravel()
    trust = count.weight / (count.weight + params.doubt)
    return (trust * ratio).astype(np.float32)


def _colour_shares(histogram: np.ndarray, params: AppearanceParams) -> np.ndarray:
    colours = histogram.reshape(histogram_shape(params)).sum(axis=3)
    smooth = ndimage.gaussian_filter(colours, params.smoothing, mode="nearest")
    return smooth / smooth.sum()


def _texture_ratio(count: ColourCount, params: AppearanceParams) -> np.ndarray:
    """Return log(share of a texture in a colour that moves / its share in this colour in the background).

    Both sides have `texture_doubt` pixels more of each colour, whose textures are those of both sides together: where
    few pixels of a colour were seen on both sides of a frame, its textures say little.
    """
    shape, widths = histogram_shape(params), (*(params.smoothing,) * 3, params.texture_smoothing)
    sides = (side.reshape(shape) for side in (count.moving_textures, count.static_textures))
    moving, static = (ndimage.gaussian_filter(side, widths, mode="nearest") for side in sides)
    both = moving + static
    unknown = params.texture_doubt * both / np.maximum(both.sum(axis=3, keepdims=True), np.finfo(float).tiny)
    return np.log(np.divide(moving + unknown, static + unknown, out=np.ones_like(both), where=unknown > 0))
