"""Check for video files that are shorter than their container says.

Decoders do not report this: a Matroska file cut in half decodes without an error, with half of its frames.
"""

import os
import struct
from collections.abc import Iterator
from typing import BinaryIO

EBML_HEADER = 0x1A45DFA3
MATROSKA_SEGMENT = 0x18538067


_MEDIA_BOXES = (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip")
"""Kinds of box with which ISO base media begin."""


def missing_bytes(path: str) -> int:
    """Return the bytes that the container announces beyond the end of the file; 0 if none, or for other formats.

    ISO base media (mp4, mov: ISO/IEC 14496-12, 4.2) and Matroska (mkv, webm: RFC 9559, RFC 8794) give the length of
    their payload; transport streams do not.
    """
    length = os.path.getsize(path)
    with open(path, "rb") as file:
        if file.read(8)[4:] in _MEDIA_BOXES:
            end = _media_data_end(file, length)
        else:
            end = _segment_end(file, length)
    return max(0, end - length)


def bytes_without_index(path: str) -> int | None:
    """Return the bytes that are missing at least if ISO base media have no whole index (``moov``), else None.

    The index of most recordings is written last: it is absent if the recording did not end, or the file was cut short.
    It is 0 if no box is cut.
    """
    length = os.path.getsize(path)
    with open(path, "rb") as file:
        if file.read(8)[4:] not in _MEDIA_BOXES:
            return None
        boxes = list(_boxes(file, length))
    if any(kind == b"moov" and end <= length for kind, end in boxes):
        return None
    return max(0, max(end for _, end in boxes) - length)


def _media_data_end(file: BinaryIO, length: int) -> int:
    """Return the position at which the last box of samples, or of a fragment's index, should end."""
    return max((end for kind, end in _boxes(file, length) if kind in (b"mdat", b"moof")), default=0)


def _boxes(file: BinaryIO, length: int) -> Iterator[tuple[bytes, int]]:
    """Yield kind and end of each box at the top of ISO base media; the last end may be beyond that of the file."""
    position = 0
    while position + 8 <= length:
        file.seek(position)
        size, kind = struct.unpack(">I4s", file.read(8))
        if size == 1:
            large = file.read(8)
            size = int.from_bytes(large, "big") if len(large) == 8 else 0
        if size < 8:
            # 0 means "to the end of the file"; 2..7 are invalid.
            yield kind, position
            return
        position += size
        yield kind, position


def _segment_end(file: BinaryIO, length: int) -> int:
    """Return where the segment should end, or the header if it alone is longer than the file of `length` bytes.

    0 for an unknown (streamed) size and for other formats.
    """
    file.seek(0)
    if _read_vint(file, keep_marker=True) != EBML_HEADER:
        return 0
    header_end = _read_vint(file) + file.tell()
    if header_end > length:
        # Up to 2^56 bytes, further than a file can be read.
        return header_end
    file.seek(header_end)
    if _read_vint(file, keep_marker=True) != MATROSKA_SEGMENT:
        return 0
    size = _read_vint(file)
    return file.tell() + size if size else 0


def _read_vint(file: BinaryIO, keep_marker: bool = False) -> int:
    """Return an EBML variable-size integer (RFC 8794, 4); 0 if it is malformed or 'unknown' (all ones)."""
    first = file.read(1)
    if not first or not first[0]:
        return 0
    num_bytes = 9 - first[0].bit_length()
    value = int.from_bytes(first + file.read(num_bytes - 1), "big")
    if keep_marker:
        return value
    value &= (1 << 7 * num_bytes) - 1
    return 0 if value == (1 << 7 * num_bytes) - 1 else value
