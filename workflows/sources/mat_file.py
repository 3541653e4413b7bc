"""Variables and structs of numbers from the bytes of MATLAB files of version 5 to 7.2.

They are not read by ``scipy.io.loadmat``, because it trusts the lengths in a damaged file until the process dies. Here
every length is compared with the bytes that are there, and any damage is an InputError that names the file.

References
----------
The MathWorks, "MAT-File Format": the Level 5 format.
"""

import math
import zlib
from collections.abc import Container, Iterator
from contextlib import contextmanager
from typing import NamedTuple

import numpy as np

from moseg.schemas.errors import InputError

_HEADER_BYTES, _TAG_BYTES, _ALIGNMENT = 128, 8, 8
_BYTE_ORDERS = {b"IM": "<", b"MI": ">"}
_MATRIX, _COMPRESSED = 14, 15
_NUMBER_TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8"}
_STRUCT_CLASS, _NUMBER_CLASSES, _COMPLEX_FLAG = 2, range(6, 16), 0x0800
# Compressed variables larger than the first may unpack to at most so many times the file (1,000 zeros take one byte).
_ALWAYS_ALLOWED_BYTES, _MAX_EXPANSION = 2**28, 100

_EXPECTED = "a MATLAB file of version 5 to 7.2"


class _DamagedError(ValueError):
    """Damage of the bytes."""


class _Element(NamedTuple):
    """An element of a file: its type and its bytes."""

    kind: int
    data: memoryview


class _Matrix(NamedTuple):
    """A variable or field: class, whether complex, shape, name, and the elements of its values."""

    kind: int
    is_complex: bool
    shape: tuple[int, ...]
    name: str
    values: Iterator[_Element]


def iterate_variables(
    content: bytes, names: Container[str], path: str
) -> Iterator[tuple[str, np.ndarray | dict[str, np.ndarray | None] | None]]:
    """Yield the names and values of a file's variables that have these names, in the order of the file.

    Parameters
    ----------
    content : bytes
        Of the whole file.
    names : container of str
    path : str
        The file, for errors.

    Yields
    ------
    str, and array, dict of str to array, or None
        Real numbers in their stored type and the shape of the variable; the fields of a single struct, each so or
        None; None for anything else.

    Raises
    ------
    InputError
        The file is not of these versions, or damaged as far as it was read.
    """
    with _naming_damage(path):
        for matrix, order in _variables(content, path):
            if matrix.name in names:
                yield matrix.name, _fields(matrix, order) if _is_single_struct(matrix) else _values(matrix, order)


@contextmanager
def _naming_damage(path: str) -> Iterator[None]:
    """Raise InputError that names the file for any damage found inside."""
    try:
        yield
    except (_DamagedError, zlib.error) as error:
        raise InputError("damaged", where=path, got=error, expected=_EXPECTED) from error


def _variables(content: bytes, path: str) -> Iterator[tuple[_Matrix, str]]:
    """Yield the variables of a file, up to their values, and the file's byte order."""
    order = _BYTE_ORDERS.get(content[_HEADER_BYTES - 2 : _HEADER_BYTES])
    if order is None or content[_HEADER_BYTES - 4 : _HEADER_BYTES - 2] not in (b"\x00\x01", b"\x01\x00"):
        raise InputError("not MATLAB's", where=path, got=f"{len(content)} bytes", expected=_EXPECTED)
    max_bytes = max(_ALWAYS_ALLOWED_BYTES, _MAX_EXPANSION * len(content))
    for element in _elements(memoryview(content)[_HEADER_BYTES:], order, max_bytes):
        if element.kind == _MATRIX:
            yield _open_matrix(element, order), order


def _elements(data: memoryview, order: str, max_bytes: int = 0) -> Iterator[_Element]:
    """Yield the elements in order; unpack compressed ones, which are not nested, to at most `max_bytes`."""
    while len(data):
        if len(data) < _TAG_BYTES:
            raise _DamagedError("a file that is cut short")
        kind, length = np.frombuffer(data[:_TAG_BYTES], order + "u4").tolist()
        start, stop = _TAG_BYTES, _TAG_BYTES + length
        if kind >> 16:
            # Four bytes or fewer are in the tag itself.
            kind, length = kind & 0xFFFF, kind >> 16
            start, stop = 4, 4 + length
            end = _TAG_BYTES
        else:
            end = stop if kind == _COMPRESSED else stop + -stop % _ALIGNMENT
        # The last element may lack its padding.
        if stop > min(end, len(data)):
            raise _DamagedError(f"{len(data)} bytes where {stop} are announced")
        if kind == _COMPRESSED and max_bytes:
            yield from _elements(_unpack(data[start:stop], max_bytes), order)
        else:
            yield _Element(kind, data[start:stop])
        data = data[end:]


def _unpack(data: memoryview, max_bytes: int) -> memoryview:
    packed = zlib.decompressobj()
    content = packed.decompress(data, max_bytes)
    if not packed.eof:
        raise _DamagedError(f"a compressed variable that is cut short or larger than {max_bytes} bytes")
    return memoryview(content)


def _open_matrix(element: _Element, order: str) -> _Matrix:
    """Return a variable up to its values; one without bytes is empty."""
    if not len(element.data):
        return _Matrix(_NUMBER_CLASSES[0], False, (0, 0), "", iter((_Element(9, element.data),)))
    parts = _elements(element.data, order)
    flags, dimensions = _numbers(_next(parts), order), _numbers(_next(parts), order)
    if flags.dtype.kind != "u" or len(flags) != 2 or dimensions.dtype.kind != "i" or dimensions.min(initial=0) < 0:
        raise _DamagedError("a variable without class or shape")
    name = bytes(_next(parts).data).decode("latin-1")
    word = int(flags[0])
    return _Matrix(word & 0xFF, bool(word & _COMPLEX_FLAG), tuple(dimensions.tolist()), name, parts)


def _is_single_struct(matrix: _Matrix) -> bool:
    return matrix.kind == _STRUCT_CLASS and math.prod(matrix.shape) == 1


def _fields(struct: _Matrix, order: str) -> dict[str, np.ndarray | None]:
    length, names = _numbers(_next(struct.values), order), bytes(_next(struct.values).data)
    if len(length) != 1 or length[0] < 1 or len(names) % length[0]:
        raise _DamagedError("a struct without names of fields")
    size = int(length[0])
    fields = [names[start : start + size].split(b"\0")[0].decode("latin-1") for start in range(0, len(names), size)]
    return {field: _array(_next(struct.values), order) for field in fields}


def _array(element: _Element, order: str) -> np.ndarray | None:
    """Return the real numbers of a field; None if it holds anything else."""
    if element.kind != _MATRIX:
        raise _DamagedError(f"a field of type {element.kind}")
    return _values(_open_matrix(element, order), order)


def _values(matrix: _Matrix, order: str) -> np.ndarray | None:
    """Return the real numbers of a variable; None if it holds anything else."""
    if matrix.kind not in _NUMBER_CLASSES or matrix.is_complex:
        return None
    values = _numbers(_next(matrix.values), order)
    if len(values) != math.prod(matrix.shape):
        raise _DamagedError(f"{len(values)} values where {matrix.shape} are announced")
    # MATLAB's first axis varies fastest.
    return values.reshape(matrix.shape, order="F")


def _numbers(element: _Element, order: str) -> np.ndarray:
    code = _NUMBER_TYPES.get(element.kind)
    if code is None or len(element.data) % np.dtype(code).itemsize:
        raise _DamagedError(f"{len(element.data)} bytes of type {element.kind} where numbers belong")
    return np.frombuffer(element.data, np.dtype(order + code))


def _next(parts: Iterator[_Element]) -> _Element:
    element = next(parts, None)
    if element is None:
        raise _DamagedError("a variable that is cut short")
    return element
