"""Pillow's images, of whose damage not a word goes to standard error."""

import io
import logging
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from PIL import Image

from moseg.schemas.errors import InputError

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


MAX_PIXELS = 2**27
"""Of one frame: 16384 x 8192. What claims more is a damaged or malicious file."""
_SEQUENCES = ("PNG", "WEBP", "TIFF")
"""Formats that may hold several frames; of a JPEG's second image (a depth map, a preview) nobody speaks as a frame."""


def check_image_header(content: bytes, path: str) -> None:
    """Raises InputError on more pixels than can be a frame, several frames in one file, or a damaged PNG.

    Bytes in which Pillow finds no image are left to the decoder.
    """
    try:
        # Sizes are judged here, and damage by the decoder.
        with open_quietly(io.BytesIO(content)) as image:
            kind, (width, height) = image.format, image.size
            num_frames = getattr(image, "n_frames", 1) if kind in _SEQUENCES else 1
    except Image.DecompressionBombError as error:
        expected = f"at most {MAX_PIXELS} px"
        raise InputError("image of too many pixels", where=path, got=error, expected=expected) from error
    except PILLOW_ERRORS:
        return
    if width * height > MAX_PIXELS:
        got, expected = f"{width}x{height} px", f"at most {MAX_PIXELS} px"
        raise InputError("image of too many pixels", where=path, got=got, expected=expected)
    if num_frames > 1:
        expected = "one a file (a GIF or a video file may hold many)"
        raise InputError("several frames in one image", where=path, got=num_frames, expected=expected)
    if kind == "PNG":
        _check_png(content, path)


def _check_png(content: bytes, path: str) -> None:
    """Checksums of all chunks, which the decoder would complain of on standard error."""
    try:
        with open_quietly(io.BytesIO(content)) as image:
            image.verify()
    except PILLOW_ERRORS as error:
        raise InputError("image cannot be decoded", where=path, got=f"{len(content)} bytes, {error}") from error
