"""One frame of an overlay: objects, their numbers, and the untouched frame beside it."""

from functools import cache

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from moseg.workflows.exports.draw_labels import draw_labels
from moseg.workflows.exports.overlay_style import OverlayStyle

# Of the frame's height, and the least height in px that is read.
_TEXT_SHARE, _LEAST_TEXT = 1 / 18, 12
# Of the text's height: white with a dark rim is read on every colour.
_STROKE_SHARE = 1 / 10


def draw_overlay(image: np.ndarray, labels: np.ndarray, style: OverlayStyle) -> np.ndarray:
    """A frame in a style.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
    labels : uint16 (y, x)
        0 = static, else an identity.
    style : OverlayStyle

    Returns
    -------
    uint8 (y, x, rgb)
        Twice as wide where the style is side by side.
    """
    drawn = draw_labels(image, labels, style)
    if style.has_identities:
        drawn = _draw_identities(drawn, labels)
    return np.hstack([image, drawn]) if style.is_side_by_side else drawn


def _draw_identities(image: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """The number of each object at the mean of its pixels, kept inside the frame."""
    height, width = labels.shape
    size = max(_LEAST_TEXT, round(height * _TEXT_SHARE))
    stroke = max(1, round(size * _STROKE_SHARE))
    canvas = Image.fromarray(image)
    pen = ImageDraw.Draw(canvas)
    y, x = np.nonzero(labels)
    identities = labels[y, x]
    areas = np.bincount(identities)
    sums = np.bincount(identities, weights=x), np.bincount(identities, weights=y)
    for identity in np.flatnonzero(areas):
        centre = [float(total[identity] / areas[identity]) for total in sums]
        half = pen.textlength(str(identity), _font(size)) / 2 + stroke, size / 2 + stroke
        place = [
            min(max(at, reach), max(side - reach, reach))
            for at, reach, side in zip(centre, half, (width, height), strict=True)
        ]
        pen.text(place, str(identity), "white", _font(size), anchor="mm", stroke_width=stroke, stroke_fill="black")
    return np.asarray(canvas)


@cache
def _font(size: int) -> ImageFont.FreeTypeFont:
    """The font that Pillow brings along: the same on every machine."""
    return ImageFont.load_default(size)
