"""Frames of an overlay: moving objects, their numbers and names, and the untouched frame beside them."""

from collections.abc import Mapping

import cv2
import numpy as np

from moseg.workflows.exports.draw_names import draw_names
from moseg.workflows.exports.overlay_style import DEFAULT_STYLE, LINED, TINTED, OverlayMode, OverlayStyle
from moseg.workflows.exports.palette import identity_colours

CUTOUT_DIMMING = 0.35
"""Share of the brightness that is kept around cut-out objects: the scene can still be recognised."""
# Wider lines need round brushes: a square one is 1.4 times as wide along diagonals.
_WIDEST_SQUARE_BRUSH = 3
NO_NAMES: Mapping[int, str] = {}


def draw_overlay(
    image: np.ndarray, labels: np.ndarray, style: OverlayStyle, names: Mapping[int, str] = NO_NAMES
) -> np.ndarray:
    """Draw a frame in a style.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
    labels : uint16 (y, x)
        0 = static, else an identity.
    style : OverlayStyle
    names : dict of int to str
        Names of objects by identity, beside their numbers where the style has these.

    Returns
    -------
    uint8 (y, x, rgb)
        Twice as wide where the style is side by side.
    """
    drawn = draw_labels(image, labels, style)
    if style.has_identities:
        drawn = draw_names(drawn, labels, names)
    return np.hstack([image, drawn]) if style.is_side_by_side else drawn


def draw_labels(image: np.ndarray, labels: np.ndarray, style: OverlayStyle = DEFAULT_STYLE) -> np.ndarray:
    """Show each moving object, by default tinted and with a line two pixels wide, one to either side, on its border.

    The tint and the line have the object's colour.

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


def _draw_outline(drawn: np.ndarray, labels: np.ndarray, width: int) -> None:
    """Colour, in place, the pixels whose neighbourhood contains more than one label."""
    if not width:
        return
    shape = cv2.MORPH_RECT if width < _WIDEST_SQUARE_BRUSH else cv2.MORPH_ELLIPSE
    brush = cv2.getStructuringElement(shape, (width + 1, width + 1))
    largest, smallest = cv2.dilate(labels, brush), cv2.erode(labels, brush)
    outline = largest != smallest
    drawn[outline] = identity_colours(largest[outline])
