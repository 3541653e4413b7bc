"""Colours of identities: the palette of PASCAL VOC and DAVIS for masks, and distinct ones for pictures."""

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


DISTINCT_COLOURS = (
    *("ff4b4b", "00ff00", "2de1ff", "e100ff", "ffd200", "f0a5f0", "4b963c", "ff00a5"),
    *("0087ff", "d2965a", "00ffc3", "b4f04b", "ff8700", "a569ff", "e17887", "c3f0a5"),
    *("969600", "00d24b", "1e96d2", "00a587", "ffe178", "f069e1", "f03c78", "ff4b00"),
    *("8787d2", "d2960f", "5afff0", "ff8769", "87ff96", "96a55a", "f000d2", "96ff00"),
)
"""Colours of identities from 1 on, RGB: each is the one farthest in CIELAB from all before it, among those with a
lightness of 55 to 92 and a chroma of 40 or more, which are visible in dark and in bright scenes.

References
----------
Glasbey et al., "Colour Displays for Categorical Images", Color Research and Application 32 (4), 2007.
"""


def identity_colours(labels: np.ndarray) -> np.ndarray:
    """Return the colour of each uint16 label, uint8 (..., rgb), the same in every frame and run; label 0 is black.

    It is for people: the palette of DAVIS has reds for 1, 8 and 9 that cannot be told apart in a video. Beyond the
    number of `DISTINCT_COLOURS`, colours repeat.
    """
    return _colours_of_all_labels()[labels]


@cache
def _colours_of_all_labels() -> np.ndarray:
    distinct = np.array([list(bytes.fromhex(colour)) for colour in DISTINCT_COLOURS], np.uint8)
    return np.concatenate([np.zeros((1, 3), np.uint8), np.resize(distinct, (2**16 - 1, 3))])
