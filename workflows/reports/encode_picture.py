"""Pictures as a page embeds them."""

import io

import numpy as np
from PIL import Image

from moseg.workflows.reports.picture_content import Picture

QUALITY = 80
"""Of pictures that lose a little, 0..100: at the size of a report the loss is not seen."""


def encode_opaque(image: np.ndarray) -> Picture:
    """uint8 (y, x, rgb) as a WebP that loses a little."""
    return _encode(image, quality=QUALITY)


def encode_transparent(image: np.ndarray) -> Picture:
    """uint8 (y, x, rgba) as a WebP that loses nothing."""
    return _encode(image, lossless=True)


def _encode(image: np.ndarray, **options) -> Picture:
    stream = io.BytesIO()
    Image.fromarray(image).save(stream, format="WebP", **options)
    height, width = image.shape[:2]
    return Picture("image/webp", stream.getvalue(), width, height)
