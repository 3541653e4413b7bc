"""Moving objects drawn into a frame."""

import cv2
import numpy as np

from workflows.exports.palette import identity_colours

TINT = 0.45
"""Share of an object's colour in its pixels: seen on foliage, with the texture still visible."""


def draw_labels(image: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Tint each moving object and draw a line two pixels wide, one to either side, along its border.

    The tint is the object's colour, the line that colour at full brightness.

    Parameters
    ----------
    image : uint8 (y, x, rgb)
    labels : uint16 (y, x)
        0 = static, left as it is.

    Returns
    -------
    uint8 (y, x, rgb)
    """
    neighbours = np.ones((3, 3), dtype=np.uint8)
    largest, smallest = cv2.dilate(labels, neighbours), cv2.erode(labels, neighbours)
    tinted = cv2.addWeighted(image, 1 - TINT, identity_colours(labels), TINT, 0)
    drawn = np.where((labels > 0)[..., None], tinted, image)
    outline = largest != smallest
    drawn[outline] = _brightest(identity_colours(largest[outline]))
    return drawn


def _brightest(colours: np.ndarray) -> np.ndarray:
    """Colours at full brightness, seen on dark scenes too: the palette's first ones reach half of it."""
    strongest = colours.max(axis=-1, keepdims=True).astype(np.uint16)
    return (colours * np.uint16(255) // strongest).astype(np.uint8)
