"""PNG files whose samples are not colours, and checks of all PNG files before they are decoded."""

import io
import struct
import zlib
from collections.abc import Iterator

import cv2
import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.sources.pillow_image import MAX_PIXELS, PILLOW_ERRORS, open_quietly
from moseg.workflows.sources.quiet_decoding import decode_quietly

MAX_BYTES = 2**28
"""Of the samples of a mask, a depth map or a flow: 16384 x 8192 px of 16 bits, or 8K in three channels."""
PNG_HEADER = struct.Struct(">8s4x4sIIBB")
"""Signature, length and name of the first chunk, width, height, bits per sample, colour type (PNG, 11.2.1)."""
_SIGNATURE, _FIRST_CHUNK = b"\x89PNG\r\n\x1a\n", b"IHDR"
_CHANNELS = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}
_CHUNK, _PIXELS, _CHECKSUM_BYTES = struct.Struct(">I4s"), b"IDAT", 4
_FEW_PIXELS, _PIECE_BYTES = 2**22, 2**20
_MAX_EXPANSION = 1032  # of deflate: 258 bytes from two bits


def check_png(content: bytes, path: object, what: str, max_bytes: int = MAX_BYTES, expansion: int = 0) -> None:
    """Raise InputError if a PNG claims more than its bytes can hold, more than `max_bytes`, or more than it holds.

    Decoders allocate memory for all of it first. For missing samples Pillow reports nothing and leaves 0, OpenCV
    refuses the file; both take seconds and gigabytes before. Only a large PNG, of more pixels than `expansion` times
    its bytes, is unpacked for that. Bytes that are not a PNG are left to the decoders.
    """
    header = _read_header(content)
    if header is None:
        _refuse_other_first_chunk(content, path, what)
        return
    _check_chunk_lengths(content, path, what)
    width, height, num_bytes = header
    got = f"{len(content)} bytes for {width}x{height} px"
    if num_bytes > _MAX_EXPANSION * len(content):
        raise InputError(f"{what} cannot be decoded", where=path, got=got)
    if width * height > MAX_PIXELS:
        got, expected = f"{width}x{height} px", f"at most {MAX_PIXELS} px"
        raise InputError(f"{what} of too many pixels", where=path, got=got, expected=expected)
    if num_bytes > max_bytes:
        raise InputError(f"{what} is too large", where=path, got=got, expected=f"at most {max_bytes} bytes unpacked")
    if width * height > max(_FEW_PIXELS, expansion * len(content)):
        _check_samples(content, num_bytes, f"{width}x{height} px", path, what)


def decode_png(content: bytes, path: object, what: str) -> np.ndarray:
    """Return the samples of a PNG unchanged, (y, x) or (y, x, channel), colours in OpenCV's order.

    Raises
    ------
    InputError
        Not an image, or one that is cut short or claims a size that it cannot have.
    """
    check_png(content, path, what)
    image, _ = decode_quietly(content, cv2.IMREAD_UNCHANGED)
    if image is None:
        raise InputError(f"{what} cannot be decoded", where=path, got=f"{len(content)} bytes")
    return image


def decode_label_png(content: bytes, path: object, what: str) -> tuple[str, np.ndarray]:
    """Return Pillow's mode of a PNG and its samples as stored, (y, x) or (y, x, channel); a palette gives indices.

    Raises
    ------
    InputError
        Not an image, or one that is cut short or claims a size that it cannot have.
    """
    check_png(content, path, what)
    try:
        with open_quietly(io.BytesIO(content)) as image:
            image.load()
            return image.mode, np.asarray(image)
    except PILLOW_ERRORS as error:
        # Pillow names the stream if it cannot identify an image.
        raise InputError(f"{what} cannot be decoded", where=path, got=f"{len(content)} bytes") from error


def _read_header(content: bytes) -> tuple[int, int, int] | None:
    """Return width, height, and the minimum bytes of the samples; None if the bytes are not a PNG."""
    if len(content) < PNG_HEADER.size:
        return None
    signature, chunk, width, height, bits, colour = PNG_HEADER.unpack_from(content)
    if signature != _SIGNATURE or chunk != _FIRST_CHUNK:
        return None
    return width, height, height * (width * bits * _CHANNELS.get(colour, 1) // 8)


def _refuse_other_first_chunk(content: bytes, path: object, what: str) -> None:
    """Raise InputError if the bytes are a PNG that does not begin with its header (PNG, 5.6): its size is not known."""
    if content.startswith(_SIGNATURE):
        got, expected = content[12:16], f"{_FIRST_CHUNK} as the first chunk"
        raise InputError(f"{what} cannot be decoded", where=path, got=got, expected=expected)


def _check_chunk_lengths(content: bytes, path: object, what: str) -> None:
    """Raise InputError if a chunk claims more bytes than follow: decoders allocate memory for all of them."""
    start = len(_SIGNATURE)
    while start + _CHUNK.size <= len(content):
        length, kind = _CHUNK.unpack_from(content, start)
        start += _CHUNK.size + length + _CHECKSUM_BYTES
        if start > len(content):
            raise InputError(f"{what} cannot be decoded", where=path, got=f"a chunk of {length} bytes beyond its end")
        if kind == b"IEND":
            return


def _check_samples(content: bytes, expected_bytes: int, size: str, path: object, what: str) -> None:
    """Raise InputError if the pixels unpack to fewer bytes than expected."""
    unpacked, num_bytes = zlib.decompressobj(), 0
    try:
        for data in _pixel_chunks(content):
            while data and not unpacked.eof:
                num_bytes += len(unpacked.decompress(data, _PIECE_BYTES))
                data = unpacked.unconsumed_tail
        num_bytes += len(unpacked.flush())
    except zlib.error as error:
        raise InputError(f"{what} cannot be decoded", where=path, got=error) from error
    if num_bytes < expected_bytes:
        got, expected = f"{num_bytes} bytes of samples", f"{expected_bytes} for {size}"
        raise InputError(f"{what} cannot be decoded", where=path, got=got, expected=expected)


def _pixel_chunks(content: bytes) -> Iterator[bytes]:
    start = len(_SIGNATURE)
    while start + _CHUNK.size <= len(content):
        length, kind = _CHUNK.unpack_from(content, start)
        start += _CHUNK.size
        if kind == _PIXELS:
            yield content[start : start + length]
        start += length + _CHECKSUM_BYTES
