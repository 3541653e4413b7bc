"""Arrays from the bytes of `.npy` and `.npz` files.

The size in a header is compared with the bytes that are there before memory is allocated, and any damage is an
InputError that names the file. Nothing is ever unpickled.
"""

import io
import lzma
import math
import struct
import warnings
import zipfile
import zlib
from typing import NamedTuple

import numpy as np
from numpy.lib import format as npy_format

from moseg.schemas.errors import InputError

HEADER_BYTES = 2**14
"""Number of bytes that are read for a header; numpy itself refuses headers beyond 10,000 characters."""
ARCHIVE_ERRORS = (
    OSError,
    ValueError,
    EOFError,
    MemoryError,
    # Of zipfile: encryption and unknown methods.
    RuntimeError,
    struct.error,
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
)
"""Exceptions of zipfile for a damaged archive or member."""

_VERSIONS = ((1, 0), (2, 0), (3, 0))
# Arrays larger than the first may have at most so many times the bytes of their archive (1,000 zeros take one byte).
_ALWAYS_ALLOWED_BYTES, _MAX_EXPANSION = 2**28, 100


class ArrayHeader(NamedTuple):
    """The header of an array, of `offset` bytes."""

    shape: tuple[int, ...]
    dtype: np.dtype
    is_fortran: bool
    offset: int

    @property
    def end(self) -> int:
        """Return the bytes of header and values."""
        return self.offset + math.prod(self.shape) * self.dtype.itemsize


def read_header(start: bytes, path: object, what: str) -> ArrayHeader:
    """Return the header at the beginning of a ``.npy`` file.

    Parameters
    ----------
    start : bytes
        All of the file or its first `HEADER_BYTES`.
    path : object
        The file, for the error.
    what : str
        What the file should hold, for the error.

    Raises
    ------
    InputError
        No header, a damaged one, or one of Python objects.
    """
    stream = io.BytesIO(start[:HEADER_BYTES])
    try:
        with warnings.catch_warnings():
            # Python warns about a damaged header, numpy about an old one.
            warnings.simplefilter("ignore")
            version = npy_format.read_magic(stream)
            if version not in _VERSIONS:
                raise ValueError(f"version {version}")
            is_first = version == (1, 0)
            read = npy_format.read_array_header_1_0 if is_first else npy_format.read_array_header_2_0
            shape, is_fortran, dtype = read(stream)
    # numpy parses the header as Python and converts it to a type: for a damaged header both raise undocumented
    # exceptions (TokenError, RecursionError, KeyError ...). Only bytes in memory are read here.
    except Exception as error:
        raise undecodable(path, what, error) from error
    shape = tuple(map(int, shape))
    if any(side < 0 for side in shape):
        raise undecodable(path, what, f"shape {shape}")
    if dtype.hasobject:
        raise undecodable(path, what, "pickled Python objects", "numbers")
    return ArrayHeader(shape, dtype, is_fortran, stream.tell())


def decode_array(content: bytes, path: object, what: str) -> np.ndarray:
    """Return the array of a ``.npy`` file, as a read-only view of its bytes.

    Raises
    ------
    InputError
        No array, one of Python objects, or fewer bytes than its shape and type take.
    """
    header = read_header(content, path, what)
    if header.end > len(content):
        got = f"{len(content)} bytes for {header.dtype} of shape {header.shape}"
        raise undecodable(path, what, got, f"{header.end} bytes")
    order = "F" if header.is_fortran else "C"
    try:
        return np.ndarray(header.shape, header.dtype, content, header.offset, order=order)
    # Sides too large for any array, next to one of 0, and types without a size.
    except (ValueError, TypeError, OverflowError) as error:
        raise undecodable(path, what, error) from error


def decode_arrays(content: bytes, names: tuple[str, ...], path: object, what: str) -> tuple[np.ndarray, ...]:
    """Return the arrays called `names` of a ``.npz`` file, each as by `decode_array`.

    Raises
    ------
    InputError
        No archive, a damaged one, an array that is absent, damaged, or of Python objects, or one that expands to far
        more than its archive.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return tuple(_decode_member(archive, name, len(content), path, what) for name in names)
    except InputError:
        raise
    except ARCHIVE_ERRORS as error:
        raise undecodable(path, what, error) from error


def undecodable(path: object, what: str, got: object, expected: object = None) -> InputError:
    """Return the error of a file whose bytes are not what they should be."""
    # numpy repeats the whole of a header that it cannot read.
    return InputError(f"{what} cannot be decoded", where=path, got=f"{got!s:.200}", expected=expected)


def _decode_member(archive: zipfile.ZipFile, name: str, num_bytes: int, path: object, what: str) -> np.ndarray:
    """Return one array of an archive of `num_bytes`."""
    members = archive.namelist()
    # numpy accepts a member without the suffix too.
    member = name if name in members else f"{name}.npy"
    if member not in members:
        raise undecodable(path, what, f"arrays {', '.join(sorted(members))}", f"an array {name}")
    with archive.open(member) as stream:
        header = read_header(stream.read(HEADER_BYTES), path, f"{what}: array {name}")
        if header.end > max(_ALWAYS_ALLOWED_BYTES, _MAX_EXPANSION * num_bytes):
            got = f"array {name} of {header.end} bytes in an archive of {num_bytes}"
            raise undecodable(path, what, got, "arrays saved by numpy.savez, uncompressed")
        stream.seek(0)
        return decode_array(stream.read(header.end), path, f"{what}: array {name}")
