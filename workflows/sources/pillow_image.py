"""Images opened with Pillow without output on standard error, and checks of their headers before decoding."""

import io
import logging
import struct
import warnings
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

import numpy as np
from PIL import Image

from moseg.schemas.errors import InputError

MAX_PIXELS = 2**27
"""Of one frame: 16384 x 8192. A file that claims more is damaged or malicious."""
PILLOW_ERRORS = (
    OSError,
    ValueError,
    EOFError,
    MemoryError,
    SyntaxError,
    # Of a TIFF without its size.
    TypeError,
    # Of chunks shorter than their content.
    LookupError,
    struct.error,
    zlib.error,
    Image.DecompressionBombError,
)
"""Exceptions of Pillow for a damaged image."""
# TIFF 6.0, section 18: the tag ExtraSamples and its value for colours that are not multiplied by alpha.
_EXTRA_SAMPLES, _UNASSOCIATED_ALPHA = 338, 2
_SEQUENCES = ("PNG", "WEBP", "TIFF")
"""Formats that may hold several frames; a JPEG's second image (a depth map, a preview) is not a frame."""

# Pillow logs damage that it also raises; without any handler Python would print it.
logging.getLogger("PIL").addHandler(logging.NullHandler())


@contextmanager
def open_quietly(source: BinaryIO | Path) -> Iterator[Image.Image]:
    """Open an image and read its header, without Pillow's warnings until the block ends.

    Raises one of `PILLOW_ERRORS` if it is damaged or not an image.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with Image.open(source) as image:
            yield image


def check_image_header(content: bytes, path: str) -> None:
    """Raise InputError for more pixels than a frame can have, several frames in one file, or a damaged PNG.

    Bytes in which Pillow finds no image are left to the decoder.
    """
    try:
        # Only the header is checked here; the decoder reports damage.
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


def has_wide_integers(content: bytes) -> bool:
    """Return whether Pillow finds integers of 32 bits in an image, which OpenCV does not decode."""
    try:
        with open_quietly(io.BytesIO(content)) as image:
            return image.mode == "I"
    except (*PILLOW_ERRORS, Image.DecompressionBombError):
        return False


def read_below_alpha(content: bytes, path: str) -> np.ndarray | None:
    """Return the colours uint8 (y, x, 3) RGB of a TIFF with 8-bit alpha by which they are not multiplied; else None.

    libtiff, by which OpenCV decodes it, multiplies them. InputError is raised if the colours are damaged.
    """
    has_clear = False
    try:
        with open_quietly(io.BytesIO(content)) as image:
            if image.format == "TIFF" and image.mode == "RGBA":
                has_clear = _UNASSOCIATED_ALPHA in image.tag_v2.get(_EXTRA_SAMPLES, ())
            return np.asarray(image.convert("RGB")) if has_clear else None
    except (*PILLOW_ERRORS, Image.DecompressionBombError) as error:
        # Of a header that Pillow cannot read nothing is known.
        if not has_clear:
            return None
        raise InputError("image cannot be decoded", where=path, got=f"{len(content)} bytes, {error}") from error


def _check_png(content: bytes, path: str) -> None:
    """Raise InputError for a wrong checksum of a chunk, about which the decoder would print on standard error."""
    try:
        with open_quietly(io.BytesIO(content)) as image:
            image.verify()
    except PILLOW_ERRORS as error:
        raise InputError("image cannot be decoded", where=path, got=f"{len(content)} bytes, {error}") from error
