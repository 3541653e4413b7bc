"""Log ratio of the colours of what moves to those of the background."""

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
    return ColourCount(
        sum(w * count.moving for w, count in zip(weights, counts, strict=True)),
        sum(w * count.static for w, count in zip(weights, counts, strict=True)),
        sum(w * count.reliability for w, count in zip(weights, counts, strict=True)),
        sum(w * count.weight for w, count in zip(weights, counts, strict=True)),
    )


def colour_ratio(count: ColourCount, params: AppearanceParams) -> np.ndarray:
    """Return log(share of a colour in what moves / its share in the background), float32 (bin,), limited to +-`clip`.

    The ratio shrinks with the weight of moving pixels; it is 0 throughout if none moves or all move.
    """
    if count.weight <= 0 or count.moving.sum() <= 0 or count.static.sum() <= 0:
        return np.zeros(len(count.moving), np.float32)
    moving, static = (_smooth_shares(side, params) for side in (count.moving, count.static))
    ratio = np.log((moving + params.floor) / (static + params.floor))
    trust = count.weight / (count.weight + params.doubt)
    return (trust * np.clip(ratio, -params.clip, params.clip)).astype(np.float32)


def _smooth_shares(histogram: np.ndarray, params: AppearanceParams) -> np.ndarray:
    widths = (*(params.smoothing,) * 3, params.texture_smoothing)
    smooth = ndimage.gaussian_filter(histogram.reshape(histogram_shape(params)), widths, mode="nearest").ravel()
    return smooth / smooth.sum()
