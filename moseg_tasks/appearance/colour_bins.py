"""Bins of colour in CIELAB."""

import cv2
import numpy as np

from schemas.parameters import AppearanceParams

_LIGHTEST = 100.0


def colour_bins(image: np.ndarray, params: AppearanceParams) -> np.ndarray:
    """Bin of each pixel's colour: `levels` each of L, a and b, which are uniform in what the eye tells apart.

    Parameters
    ----------
    image : float32 (y, x, 3)
        RGB, 0..255.
    params : AppearanceParams

    Returns
    -------
    bins : uint16 (y, x)
        ``(L * levels + a) * levels + b``.
    """
    lab = cv2.cvtColor(image * np.float32(1 / 255), cv2.COLOR_RGB2LAB)
    levels, half = params.levels, params.chroma_range / 2
    scale = np.array([levels / _LIGHTEST, levels / params.chroma_range, levels / params.chroma_range], np.float32)
    offset = np.array([0.0, half * scale[1], half * scale[2]], np.float32)
    indices = np.clip(lab * scale + offset, 0, levels - 1).astype(np.int32)
    return ((indices[..., 0] * levels + indices[..., 1]) * levels + indices[..., 2]).astype(np.uint16)
