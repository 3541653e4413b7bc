"""PNG files of samples that are no colours, and what their headers may claim."""

import struct
import zlib

import cv2
import numpy as np
from PIL import Image

from schemas.errors import InputError

PNG_HEADER = struct.Struct(">8s4x4sIIBB")
"""Signature, length and name of the first chunk, width, height, bits a sample, colour type (PNG, 11.2.1)."""
PILLOW_ERRORS = (
    OSError,
    ValueError,
    EOFError,
    MemoryError,
    SyntaxError,
    # Of chunks shorter than what they should hold.
    LookupError,
    struct.error,
    zlib.error,
    Image.DecompressionBombError,
)
"""What Pillow raises where an image is damaged."""

_SIGNATURE, _FIRST_CHUNK = b"\x89PNG\r\n\x1a\n", b"IHDR"
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
_MOST_EXPANSION = 1032  # of deflate: 258 bytes from two bits


def check_png_size(content: bytes, path: object, what: str) -> None:
    """Raises InputError where the header of a PNG claims more pixels than its bytes can hold.

    Decoders take memory for all of them first. Bytes that are no PNG are left to them.
    """
    if len(content) < PNG_HEADER.size:
        return
    signature, chunk, width, height, bits, colour = PNG_HEADER.unpack_from(content)
    if signature != _SIGNATURE or chunk != _FIRST_CHUNK:
        return
    if height * (width * bits * _CHANNELS.get(colour, 1) // 8) > _MOST_EXPANSION * len(content):
        raise InputError(f"{what} cannot be decoded", where=path, got=f"{len(content)} bytes for {width}x{height} px")


def decode_png(content: bytes, path: object, what: str) -> np.ndarray:
    """Samples of a PNG as they stand, (y, x) or (y, x, channel), colours in OpenCV's order.

    Raises
    ------
    InputError
        No image, or one that is cut short or claims another size than it can have.
    """
    check_png_size(content, path, what)
    try:
        image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        image = None
    if image is None:
        raise InputError(f"{what} cannot be decoded", where=path, got=f"{len(content)} bytes")
    return image
