"""Regions as a transparent picture that can lie over any other."""

from typing import NamedTuple

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from moseg.workflows.sources.resize import resize_labels

LINE = 2
"""Usual width of a region's border, px, half of it to either side."""
RIM = 1
"""Width of the dark rim around it, px, by which the border is visible on its own colour."""
RIM_OPACITY = 0.6
HATCH = (128, 128, 128)
"""RGB of the stripes over pixels that do not count."""
_HATCH_STEP, _HATCH_OPACITY = 6, 0.75
_TEXT = 15
# Pictures are drawn this many times as large and reduced, so that borders are smooth.
_OVERSAMPLING = 2


class RegionStyle(NamedTuple):
    """How regions are drawn.

    Attributes
    ----------
    opacity : float
        Share of a region's colour in its pixels, 0..1.
    line : int
        Width of its border, px, half of it to either side; 0 is none, for regions as thin as a border.
    is_numbered : bool
        Whether each region bears its number.
    """

    opacity: float
    line: int = LINE
    is_numbered: bool = False


def draw_regions(
    regions: np.ndarray,
    colours: np.ndarray,
    shape: tuple[int, int],
    style: RegionStyle,
    hatched: np.ndarray | None = None,
) -> np.ndarray:
    """Tint each region and draw a line along its border, with a thin dark rim around all.

    Parameters
    ----------
    regions : uint16 (y, x)
        0 = no region.
    colours : uint8 (num_colours, rgb)
        By region.
    shape : (int, int)
        Height and width of the picture, px.
    style : RegionStyle
    hatched : bool (y, x), optional
        Striped in grey; the regions lie above.

    Returns
    -------
    uint8 (y, x, rgba)
        Transparent where there is neither a region nor a stripe.
    """
    large = tuple(side * _OVERSAMPLING for side in shape)
    labels = resize_labels(regions.astype(np.uint16), large)
    brush = _round_brush(style.line)
    largest, smallest = cv2.dilate(labels, brush), cv2.erode(labels, brush)
    line = largest != smallest
    rim = cv2.dilate(largest, _round_brush(2 * RIM)) > 0
    # From the bottom to the top: each replaces those below.
    canvas = np.zeros((*large, 4), np.float32)
    if hatched is not None:
        y, x = np.indices(large)
        stripes = (x + y) // _OVERSAMPLING % _HATCH_STEP < _HATCH_STEP / 3
        canvas[stripes & (resize_labels(hatched.astype(np.uint8), large) > 0)] = _ink(np.array(HATCH), _HATCH_OPACITY)
    canvas[rim] = _ink(np.zeros(3), RIM_OPACITY)
    inside = labels > 0
    canvas[inside] = _ink(colours[labels[inside]], style.opacity)
    canvas[line] = _ink(colours[largest[line]], 1)
    drawn = reduce_transparent(canvas, shape)
    return _draw_numbers(drawn, resize_labels(regions.astype(np.uint16), shape)) if style.is_numbered else drawn


def reduce_transparent(weighted: np.ndarray, shape: tuple[int, int]) -> np.ndarray:
    """Reduce a transparent picture to `shape`; pixels are weighted by opacity, so that edges keep their colours.

    Parameters
    ----------
    weighted : float32 (y, x, rgba)
        Colours, 0..255, multiplied by the opacity, 0..1; and the opacity.
    shape : (int, int)
        Height and width, px, at most the picture's.

    Returns
    -------
    uint8 (y, x, rgba)
    """
    reduced = cv2.resize(weighted, (shape[1], shape[0]), interpolation=cv2.INTER_AREA)
    drawn = np.zeros((*shape, 4), np.uint8)
    # Most of a picture is often empty.
    is_drawn = reduced[..., 3] > 0
    found = reduced[is_drawn]
    opacity = found[:, 3:]
    mean = found[:, :3] / np.maximum(opacity, 1e-6)
    drawn[is_drawn] = np.rint(np.hstack([np.clip(mean, 0, 255), 255 * opacity]))
    return drawn


def _ink(colours: np.ndarray, opacity: float) -> np.ndarray:
    """Return colours (..., rgb) multiplied by their opacity, and the opacity, float32 (..., rgba)."""
    ink = np.full((*colours.shape[:-1], 4), opacity, np.float32)
    ink[..., :3] *= colours
    return ink


def _round_brush(width: int) -> np.ndarray:
    side = width * _OVERSAMPLING + 1
    return cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (side, side))


def _draw_numbers(drawn: np.ndarray, regions: np.ndarray) -> np.ndarray:
    """Draw each region's number at its innermost pixel, where it fits."""
    canvas = Image.fromarray(drawn)
    pen = ImageDraw.Draw(canvas)
    font = ImageFont.load_default(_TEXT)
    for region in np.flatnonzero(np.bincount(regions.ravel())[1:]) + 1:
        # Padded with zeros: the image border counts as a border of the region.
        inside = cv2.copyMakeBorder((regions == region).astype(np.uint8), 1, 1, 1, 1, cv2.BORDER_CONSTANT, value=0)
        depth = cv2.distanceTransform(inside, cv2.DIST_L2, 3)[1:-1, 1:-1]
        if depth.max() < _TEXT / 2:
            continue
        y, x = np.unravel_index(depth.argmax(), depth.shape)
        pen.text((x, y), str(region), (255, 255, 255, 255), font, anchor="mm", stroke_width=2, stroke_fill="black")
    return np.asarray(canvas)
