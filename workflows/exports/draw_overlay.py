"""Frames of an overlay: moving objects, their numbers, and the untouched frame beside them."""

from functools import cache

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from moseg.workflows.exports.overlay_style import DEFAULT_STYLE, LINED, TINTED, OverlayMode, OverlayStyle
from moseg.workflows.exports.palette import identity_colours

CUTOUT_DIMMING = 0.35
"""Share of the brightness that is kept around cut-out objects: the scene can still be recognised."""
# Wider lines need round brushes: a square one is 1.4 times as wide along diagonals.
_WIDEST_SQUARE_BRUSH = 3
# Of the frame's height, and the smallest legible height, px.
_TEXT_SHARE, _MIN_TEXT = 1 / 18, 12
# Of the text's height: white with a dark rim is legible on every colour.
_STROKE_SHARE = 1 / 10


def draw_overlay(image: np.ndarray, labels: np.ndarray, style: OverlayStyle) -> np.ndarray:
    """Draw a frame in a style.

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


def draw_labels(image: np.ndarray, labels: np.ndarray, style: OverlayStyle = DEFAULT_STYLE) -> np.ndarray:
    """Show each moving object, by default tinted and with a line two pixels wide, one to either side, on its border.

    The tint is the object's colour, the line that colour at full brightness.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
    labels : uint16 (y, x)
        0 = static, left as it is.
    style : OverlayStyle
        Numbers and the untouched frame are drawn by `draw_overlay`, not here.

    Returns
    -------
    uint8 (y, x, rgb)
    """
    if style.mode is OverlayMode.MASK:
        return identity_colours(labels)
    drawn = image.copy()
    moves = labels > 0
    if style.mode is OverlayMode.CUTOUT:
        grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
        drawn[~moves] = np.rint(CUTOUT_DIMMING * grey[~moves]).astype(np.uint8)[:, None]
    if style.mode in TINTED:
        tinted = cv2.addWeighted(image, 1 - style.opacity, identity_colours(labels), style.opacity, 0)
        drawn = np.where(moves[..., None], tinted, drawn)
    if style.mode in LINED:
        _draw_outline(drawn, labels, style.outline_width)
    return drawn


def brightest(colours: np.ndarray) -> np.ndarray:
    """Return colours at full brightness, uint8 (..., rgb), for dark scenes: the palette's first ones reach half."""
    strongest = colours.max(axis=-1, keepdims=True).astype(np.uint16)
    return (colours * np.uint16(255) // np.maximum(strongest, 1)).astype(np.uint8)


def _draw_outline(drawn: np.ndarray, labels: np.ndarray, width: int) -> None:
    """Colour, in place, the pixels whose neighbourhood contains more than one label."""
    if not width:
        return
    shape = cv2.MORPH_RECT if width < _WIDEST_SQUARE_BRUSH else cv2.MORPH_ELLIPSE
    brush = cv2.getStructuringElement(shape, (width + 1, width + 1))
    largest, smallest = cv2.dilate(labels, brush), cv2.erode(labels, brush)
    outline = largest != smallest
    drawn[outline] = brightest(identity_colours(largest[outline]))


def _draw_identities(image: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Draw the number of each object at the mean of its pixels, inside the frame."""
    height, width = labels.shape
    size = max(_MIN_TEXT, round(height * _TEXT_SHARE))
    stroke = max(1, round(size * _STROKE_SHARE))
    canvas = Image.fromarray(image)
    pen = ImageDraw.Draw(canvas)
    y, x = np.nonzero(labels)
    identities = labels[y, x]
    areas = np.bincount(identities)
    sums = np.bincount(identities, weights=x), np.bincount(identities, weights=y)
    for identity in np.flatnonzero(areas):
        centre = [float(total[identity] / areas[identity]) for total in sums]
        half = pen.textlength(str(identity), default_font(size)) / 2 + stroke, size / 2 + stroke
        place = [
            min(max(at, reach), max(side - reach, reach))
            for at, reach, side in zip(centre, half, (width, height), strict=True)
        ]
        pen.text(
            place, str(identity), "white", default_font(size), anchor="mm", stroke_width=stroke, stroke_fill="black"
        )
    return np.asarray(canvas)


@cache
def default_font(size: int) -> ImageFont.FreeTypeFont:
    """Return the font that comes with Pillow, the same on every machine."""
    return ImageFont.load_default(size)
