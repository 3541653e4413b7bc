"""Pillow's images, of whose damage not a word goes to standard error."""

import logging
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from PIL import Image

PILLOW_ERRORS = (
    OSError,
    ValueError,
    EOFError,
    MemoryError,
    SyntaxError,
    # Of a TIFF without its size.
    TypeError,
    # Of chunks shorter than what they should hold.
    LookupError,
    struct.error,
    zlib.error,
    Image.DecompressionBombError,
)
"""What Pillow raises where an image is damaged."""

# What Pillow logs of a damaged image it raises as well; without any handler Python would print it.
logging.getLogger("PIL").addHandler(logging.NullHandler())


@contextmanager
def open_quietly(source: BinaryIO | Path) -> Iterator[Image.Image]:
    """An image whose header was read, without Pillow's warnings of odd ones until the block ends.

    Raises one of `PILLOW_ERRORS` where it is damaged or none.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with Image.open(source) as image:
            yield image
