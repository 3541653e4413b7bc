"""Colours of identities: the palette of PASCAL VOC and DAVIS."""

from functools import cache

import numpy as np


@cache
def davis_palette() -> np.ndarray:
    """Return the 256 colours of the PASCAL VOC palette, uint8 (256, rgb), read-only; index 0 is black.

    Bits 0, 3 and 6 of the index are the highest, second and third bit of red, bits 1, 4 and 7 those of green, and
    bits 2 and 5 those of blue.

    References
    ----------
    Everingham et al., "The PASCAL Visual Object Classes Challenge 2012 Development Kit", VOClabelcolormap.
    """
    index = np.arange(256)
    palette = np.zeros((256, 3), dtype=np.uint8)
    for channel in range(3):
        for level in range(3):
            bit = index >> (3 * level + channel) & 1
            palette[:, channel] |= (bit << (7 - level)).astype(np.uint8)
    palette.flags.writeable = False
    return palette


def identity_colours(labels: np.ndarray) -> np.ndarray:
    """Return the colour of each uint16 label, uint8 (..., rgb), the same in every frame and run; label 0 is black.

    It is the palette's, so that an object has one colour in the overlay and in its mask; beyond 255 colours repeat.
    """
    return _colours_of_all_labels()[labels]


@cache
def _colours_of_all_labels() -> np.ndarray:
    repeats = -(-(2**16) // 255)
    return np.concatenate([davis_palette()[:1], np.tile(davis_palette()[1:], (repeats, 1))])
