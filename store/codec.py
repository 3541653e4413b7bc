"""Conversion of arrays to the files of a Zarr v3 group and back, in memory.

Zarr writes the metadata, once for each kind of array; the chunks are encoded directly by the codecs that the metadata
names, to the same bytes. Zarr itself, with a coroutine and a task for every chunk and codec, takes 3 ms an array
whatever its size, several times as long as encoding a flow field. An array whose metadata has another spelling, as of
another version of Zarr, is decoded by Zarr.

Blosc at level 1, then CRC-32C. Images are compressed by Zstandard with bit shuffle, floats by LZ4 with bit shuffle, and
labels and flags by LZ4 with byte shuffle. Chosen on real data (DAVIS 480p, one core): an RGB frame of 1.2 MB encodes by
Zstandard in 3.3 ms and decodes in 2.0 ms to 76 % of its size, by LZ4 in 0.7 ms and 0.2 ms to 94 %. Maps of float16
encode by LZ4 in 40 % of the time of Zstandard, to 40 % to 75 % of their size instead of 20 % to 65 %; most of them are
cues, which `segment` lets go of. Labels take 1 % of their size by either, and decode four times as fast by LZ4. Earlier
versions wrote all by LZ4 with byte shuffle, or floats by Zstandard.
"""

import itertools
import math
import struct
from collections.abc import Iterable, Mapping
from functools import cache, lru_cache

import google_crc32c
import numpy as np
from numcodecs import blosc
from zarr.api.asynchronous import create_array, create_group, open_array
from zarr.buffer.cpu import Buffer
from zarr.codecs import BloscCodec, BytesCodec, Crc32cCodec
from zarr.storage import MemoryStore

from moseg.schemas.digests import hash_array
from moseg.schemas.errors import StoreError
from moseg.schemas.manifests import ArrayEntry
from moseg.store.inline_loop import run_inline

METADATA = "zarr.json"
_INTEGERS = ("int8", "int16", "int32", "int64", "uint8", "uint16", "uint32", "uint64")
DTYPES = frozenset({"bool", *_INTEGERS, "float16", "float32", "float64", "complex64", "complex128"})
"""Dtypes that the Zarr specification fixes to the bit."""
ROW_AXES = frozenset({"frame", "pair"})
"""Names of leading axes that are read one row at a time: one chunk per row."""
MAX_CHUNK_BYTES = 2**31 - 1 - 16
"""Blosc's limit on one buffer (BLOSC_MAX_BUFFERSIZE)."""

_LEVEL = 1
_SMALL, _FAST, _BYTES = ("zstd", "bitshuffle"), ("lz4", "bitshuffle"), ("lz4", "shuffle")
"""Compressors with their shuffles."""
_CHECKSUM_BYTES = 4
_BLOSC_SIZES = struct.Struct("<4xI4xI")  # of Blosc's header: bytes decoded and bytes encoded
_METADATA_KEPT = 1024  # a run has a few dozen kinds of arrays, each with some 1.5 kB of metadata
_FIRST_MARK = 987_650_001  # a size that stands for another one in a template, in no other place of the metadata


def encode_group(
    arrays: Mapping[str, np.ndarray],
    dims: Mapping[str, tuple[str, ...]],
    digests: Mapping[str, str] | None = None,
) -> tuple[dict[str, memoryview], tuple[ArrayEntry, ...]]:
    """Return the files of a Zarr group that holds `arrays`, by relative path, and an entry per array in order of name.

    `digests` are those of `hash_array` for the arrays for which the caller has them.

    Raises
    ------
    StoreError
        A dtype that Zarr does not store portably, or one chunk over 2 GiB.
    """
    files = {METADATA: _group_metadata()}
    known = digests or {}
    entries = tuple([_encode_array(files, name, arrays[name], dims[name], known.get(name)) for name in sorted(arrays)])
    return {path: memoryview(files[path]) for path in sorted(files)}, entries


def decode_array(entry: ArrayEntry, files: Mapping[str, bytes], rows: slice = slice(None)) -> np.ndarray:
    """Decode one array, or rows of its leading axis, from the files that `array_files` names.

    Raises whatever Zarr raises on bytes that it cannot decode, and ValueError if its metadata differs from the entry or
    a chunk's checksum or length is wrong.
    """
    chunks = chunk_shape(entry.shape, entry.dims)
    if not _is_blosc(files[f"{entry.name}/{METADATA}"], entry, chunks):
        store = MemoryStore({path: Buffer.from_bytes(content) for path, content in files.items()})
        return run_inline(_decode_by_zarr(store, entry, rows))
    paths = array_files(entry, rows)[1:]
    found = np.empty((len(paths), math.prod(chunks)), entry.dtype)
    for path, chunk in zip(paths, found, strict=True):
        _decode_chunk(files[path], chunk)
    if not entry.shape:
        return found.reshape(())
    start, stop, _ = rows.indices(entry.shape[0])
    num_rows = max(0, stop - start)
    if 0 in entry.shape:
        return np.empty((num_rows, *entry.shape[1:]), entry.dtype)
    first = start % chunks[0]
    return found.reshape(-1, *entry.shape[1:])[first : first + num_rows]


def array_files(entry: ArrayEntry, rows: slice = slice(None)) -> list[str]:
    """Return the relative paths of the files of an array, or of rows of its leading axis: metadata, then chunks."""
    if 0 in entry.shape:
        return [f"{entry.name}/{METADATA}"]
    chunks = chunk_shape(entry.shape, entry.dims)
    grid = [range(-(-size // chunk)) for size, chunk in zip(entry.shape, chunks, strict=True)]
    if grid:
        start, stop, _ = rows.indices(entry.shape[0])
        grid[0] = range(start // chunks[0], -(-stop // chunks[0])) if stop > start else range(0)
    return [f"{entry.name}/{METADATA}"] + [f"{entry.name}/{_chunk_name(index)}" for index in itertools.product(*grid)]


def chunk_shape(shape: tuple[int, ...], dims: Iterable[str]) -> tuple[int, ...]:
    """Return the shape of a chunk: one frame or frame pair if the leading axis counts these, else the whole array."""
    leading = next(iter(dims), None)
    whole = tuple(max(1, size) for size in shape)
    return (1, *whole[1:]) if len(shape) >= 3 and leading in ROW_AXES else whole


def _encode_array(
    files: dict[str, bytes], name: str, array: np.ndarray, dims: tuple[str, ...], digest: str | None
) -> ArrayEntry:
    if array.dtype.name not in DTYPES:
        raise StoreError("dtype that cannot be stored", where=name, got=array.dtype, expected=", ".join(sorted(DTYPES)))
    chunks = chunk_shape(array.shape, dims)
    nbytes = array.itemsize * int(np.prod(chunks, dtype=np.int64))
    if nbytes > MAX_CHUNK_BYTES:
        raise StoreError(
            "array too large for one chunk", where=name, got=f"{nbytes} bytes", expected=f"<= {MAX_CHUNK_BYTES}"
        )
    array = np.asarray(array, dtype=array.dtype.newbyteorder("<"), order="C")
    digest = digest or hash_array(array)
    entry = ArrayEntry(name=name, dtype=array.dtype.str, shape=array.shape, dims=dims, digest=digest)
    metadata, *paths = array_files(entry)
    files[metadata] = _array_metadata(array.shape, array.dtype.str, chunks, tuple(dims), _compressor(array.dtype))
    for path, chunk in zip(paths, array.reshape(len(paths), -1) if paths else (), strict=True):
        files[path] = _encode_chunk(chunk)
    return entry


def _encode_chunk(chunk: np.ndarray) -> bytes:
    name, shuffle = _compressor(chunk.dtype)
    number = blosc.BITSHUFFLE if shuffle == "bitshuffle" else blosc.SHUFFLE
    encoded = blosc.compress(chunk.view(np.uint8), name.encode(), _LEVEL, number, typesize=chunk.itemsize)
    return b"".join([encoded, google_crc32c.value(encoded).to_bytes(_CHECKSUM_BYTES, "little")])


def _decode_chunk(content: bytes, chunk: np.ndarray) -> None:
    """Decode a chunk's file into `chunk`, which must be contiguous."""
    encoded = np.frombuffer(content, np.uint8)[:-_CHECKSUM_BYTES]
    if google_crc32c.value(encoded).to_bytes(_CHECKSUM_BYTES, "little") != content[-_CHECKSUM_BYTES:]:
        raise ValueError("the chunk's checksum differs")
    nbytes, num_encoded = _BLOSC_SIZES.unpack_from(encoded)
    if (nbytes, num_encoded) != (chunk.nbytes, len(encoded)):
        raise ValueError(f"a chunk of {nbytes} bytes where the manifest has {chunk.nbytes}")
    blosc.decompress(encoded, chunk.view(np.uint8))


async def _decode_by_zarr(store: MemoryStore, entry: ArrayEntry, rows: slice) -> np.ndarray:
    stored = await open_array(store=store, path=entry.name, mode="r")
    # Zarr reads an empty list of names (an array without axes) as None
    found = (stored.dtype.str, stored.shape, stored.metadata.dimension_names or (), stored.chunks)
    expected = (entry.dtype, entry.shape, entry.dims, chunk_shape(entry.shape, entry.dims))
    if found != expected:
        raise ValueError(f"Zarr metadata {found} where the manifest has {expected}")
    return np.asarray(await stored.getitem(rows if entry.shape else ...))


def _is_blosc(metadata: bytes, entry: ArrayEntry, chunks: tuple[int, ...]) -> bool:
    """Return whether an array's metadata is that which this or an earlier version writes; Blosc decodes each."""
    return any(
        metadata == _array_metadata(entry.shape, entry.dtype, chunks, entry.dims, compressor)
        for compressor in (_compressor(np.dtype(entry.dtype)), _BYTES, _SMALL)
    )


def _compressor(dtype: np.dtype) -> tuple[str, str]:
    if dtype == np.uint8:
        return _SMALL
    return _FAST if dtype.kind in "fc" else _BYTES


@lru_cache(_METADATA_KEPT)
def _array_metadata(
    shape: tuple[int, ...],
    dtype: str,
    chunks: tuple[int, ...],
    dims: tuple[str, ...],
    compressor: tuple[str, str],
) -> bytes:
    """Return Zarr's metadata of an array as it is stored here."""
    template = _metadata_template(dtype, dims, compressor)
    return template % tuple(str(size).encode("ascii") for size in (*shape, *chunks))


@cache
def _metadata_template(dtype: str, dims: tuple[str, ...], compressor: tuple[str, str]) -> bytes:
    """Return Zarr's metadata of arrays that differ in their sizes only, with a ``%b`` for each size of the shape and
    of the chunks: Zarr takes milliseconds to write it."""
    marks = range(_FIRST_MARK, _FIRST_MARK + 2 * len(dims))
    files: dict[str, Buffer] = {}
    created = create_array(
        MemoryStore(files),
        name="array",
        shape=tuple(marks[: len(dims)]),
        dtype=dtype,
        chunks=tuple(marks[len(dims) :]),
        filters=None,
        serializer=BytesCodec(),
        compressors=[
            BloscCodec(cname=compressor[0], clevel=_LEVEL, shuffle=compressor[1], typesize=np.dtype(dtype).itemsize),
            Crc32cCodec(),
        ],
        # "c.0.1" instead of "c/0/1": no folder per chunk
        chunk_key_encoding={"name": "default", "separator": "."},
        dimension_names=dims,
    )
    run_inline(created)
    template = files[f"array/{METADATA}"].to_bytes().replace(b"%", b"%%")
    for mark in marks:
        template = template.replace(str(mark).encode("ascii"), b"%b")
    return template


@cache
def _group_metadata() -> bytes:
    files: dict[str, Buffer] = {}
    run_inline(create_group(store=MemoryStore(files)))
    return files[METADATA].to_bytes()


def _chunk_name(index: tuple[int, ...]) -> str:
    return ".".join(["c", *map(str, index)])
