"""The pack of an artifact: its Zarr group as one uncompressed ZIP archive, which Zarr's `ZipStore` reads.

A file costs a block of the disk and a call of the system, on an object store a request, whatever its size. The bytes of
a pack follow from the files alone. So the place of each file follows from the sizes in the manifest, and reading takes
no directory of the archive; and every byte between the files can be compared with what it must be.
"""

import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from moseg.schemas.manifests import FileEntry

PACK = "arrays.zip"
MAX_FILES = 65_534
MAX_BYTES = 2**32 - 2**24
"""Limits of an archive without extensions; a larger artifact is stored in files of its own."""

_LOCAL = struct.Struct("<4s5H3L2H")
_CENTRAL = struct.Struct("<4s6H3L5H2L")
_END = struct.Struct("<4s4H2LH")
_VERSION, _UTF8, _STORED, _TIME, _DATE = 20, 0x800, 0, 0, 0x21
_PERMISSIONS = 0o644 << 16


class Range(NamedTuple):
    """The place of a file in a pack."""

    start: int
    nbytes: int


def is_packable(files: Mapping[str, bytes | memoryview]) -> bool:
    """Return whether an archive without extensions holds the files."""
    entries = [FileEntry(path=path, nbytes=len(content)) for path, content in files.items()]
    return len(files) <= MAX_FILES and pack_nbytes(entries) <= MAX_BYTES


def pack(files: Mapping[str, bytes | memoryview]) -> bytes:
    """Return the pack of files by relative path, in their order."""
    parts: list[bytes | memoryview] = []
    directory: list[bytes] = []
    offset = 0
    for path, content in files.items():
        name, nbytes = path.encode("utf-8"), len(content)
        described = (_UTF8, _STORED, _TIME, _DATE, zlib.crc32(content), nbytes, nbytes, len(name), 0)
        parts += [_LOCAL.pack(b"PK\3\4", _VERSION, *described), name, content]
        directory += [
            _CENTRAL.pack(b"PK\1\2", _VERSION, _VERSION, *described, 0, 0, 0, _PERMISSIONS, offset),
            name,
        ]
        offset += _LOCAL.size + len(name) + nbytes
    length = sum(map(len, directory))
    end = _END.pack(b"PK\5\6", 0, 0, len(files), len(files), length, offset, 0)
    return b"".join([*parts, *directory, end])


def pack_nbytes(entries: Iterable[FileEntry]) -> int:
    """Return the bytes of a pack of files of these sizes."""
    lengths = [(len(entry.path.encode("utf-8")), entry.nbytes) for entry in entries]
    return _END.size + sum(_LOCAL.size + _CENTRAL.size + 2 * name + nbytes for name, nbytes in lengths)


def places(entries: Sequence[FileEntry]) -> dict[str, Range]:
    """Return where each file lies in the pack."""
    found: dict[str, Range] = {}
    offset = 0
    for entry in entries:
        start = offset + _LOCAL.size + len(entry.path.encode("utf-8"))
        found[entry.path] = Range(start, entry.nbytes)
        offset = start + entry.nbytes
    return found
