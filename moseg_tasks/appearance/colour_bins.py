"""Bins of colour in CIELAB."""

import cv2
import numpy as np

from moseg.schemas.parameters import AppearanceParams

_BYTES = np.arange(256)
_GREY = 128  # a and b of a colour without chroma, as OpenCV keeps them in a byte


def colour_bins(image: np.ndarray, params: AppearanceParams) -> np.ndarray:
    """Bin of each pixel's colour: `levels` each of L, a and b, which are uniform in what the eye tells apart.

    Parameters
    ----------
    image : uint8 (y, x, 3)
        RGB.
    params : AppearanceParams

    Returns
    -------
    bins : uint16 (y, x)
        ``(L * levels + a) * levels + b``.
    """
    lightness, a, b = cv2.split(cv2.cvtColor(image, cv2.COLOR_RGB2LAB))
    levels = params.levels
    light = _BYTES * levels // 256
    # Half a byte off the edge between two bins: grey lies there.
    chroma = np.floor((_BYTES - _GREY + 0.5) * levels / params.chroma_range + levels / 2).clip(0, levels - 1)
    tables = (light * levels**2, chroma * levels, chroma)
    return sum(np.take(table.astype(np.uint16), side) for table, side in zip(tables, (lightness, a, b), strict=True))
