"""Check for video files that are shorter than their container says.

Decoders do not report this: a Matroska file cut in half decodes without an error, with half of its frames.
"""

import os
import struct
from typing import BinaryIO

EBML_HEADER = 0x1A45DFA3
MATROSKA_SEGMENT = 0x18538067


def missing_bytes(path: str) -> int:
    """Return the bytes that the container announces beyond the end of the file; 0 if none, or for other formats.

    ISO base media (mp4, mov: ISO/IEC 14496-12, 4.2) and Matroska (mkv, webm: RFC 9559, RFC 8794) give the length of
    their payload; transport streams do not.
    """
    length = os.path.getsize(path)
    with open(path, "rb") as file:
        if file.read(8)[4:] in (b"ftyp", b"moov", b"mdat", b"wide", b"free", b"skip"):
            end = _media_data_end(file, length)
        else:
            end = _segment_end(file, length)
    return max(0, end - length)


def _media_data_end(file: BinaryIO, length: int) -> int:
    """Return the position at which the last box of samples, or of a fragment's index, should end."""
    position = end = 0
    while position + 8 <= length:
        file.seek(position)
        size, kind = struct.unpack(">I4s", file.read(8))
        if size == 1:
            large = file.read(8)
            size = int.from_bytes(large, "big") if len(large) == 8 else 0
        if size < 8:
            # 0 means "to the end of the file"; 2..7 are invalid.
            break
        position += size
        if kind in (b"mdat", b"moof"):
            end = position
    return end


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
