"""Round trips of every dtype and shape, and the stored Zarr as Zarr itself reads it."""

import json
from pathlib import Path

import numpy as np
import pytest
import zarr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from moseg.schemas.manifests import ArrayEntry
from moseg.store import codec
from moseg.store.codec import DTYPES, array_files, chunk_shape, decode_array, encode_group

SHAPES = npst.array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=4)
AXES = st.sampled_from([("frame", "y", "x", "uv"), ("pair", "y", "x", "uv"), ("a", "b", "c", "d")])


def stored_bytes(files: dict) -> dict[str, bytes]:
    return {path: content.tobytes() for path, content in files.items()}


def decode(entry: ArrayEntry, files: dict[str, bytes], rows: slice = slice(None)) -> np.ndarray:
    return decode_array(entry, {path: files[path] for path in array_files(entry, rows)}, rows)


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(
    array=st.sampled_from(sorted(DTYPES)).flatmap(lambda dtype: npst.arrays(np.dtype(dtype), SHAPES)),
    axes=AXES,
    order=st.sampled_from("CF"),
    byte_order=st.sampled_from("<>"),
)
def test_round_trip_keeps_dtype_shape_and_bytes(array, axes, order, byte_order):
    given_array = np.array(array, dtype=array.dtype.newbyteorder(byte_order), order=order)
    files, (entry,) = encode_group({"x": given_array}, {"x": axes[: array.ndim]})
    found = decode(entry, stored_bytes(files))
    assert found.dtype == array.dtype and found.shape == array.shape
    assert found.tobytes() == array.tobytes()


@settings(max_examples=40, deadline=None)
@given(data=st.data(), shape=npst.array_shapes(min_dims=1, max_dims=4, min_side=1, max_side=5), axes=AXES)
def test_rows_decode_from_the_files_that_array_files_lists(data, shape, axes):
    array = np.arange(np.prod(shape), dtype=np.int32).reshape(shape)
    start = data.draw(st.integers(0, shape[0]))
    rows = slice(start, data.draw(st.integers(start, shape[0])))
    files, (entry,) = encode_group({"x": array}, {"x": axes[: array.ndim]})
    assert np.array_equal(decode(entry, stored_bytes(files), rows), array[rows])


@pytest.mark.parametrize("dtype", sorted(DTYPES))
@pytest.mark.parametrize("shape", [(), (3,), (2, 3, 4)])
def test_arrays_of_zeros_have_all_their_chunks(dtype, shape):
    files, (entry,) = encode_group({"x": np.zeros(shape, dtype)}, {"x": ("frame", "y", "x")[: len(shape)]})
    assert sorted(files) == sorted(["zarr.json", *array_files(entry)])
    assert len(files) == 2 + (2 if len(shape) == 3 else 1)


def test_chunks_follow_frames_and_pairs_only():
    assert chunk_shape((40, 480, 854), ("frame", "y", "x")) == (1, 480, 854)
    assert chunk_shape((40, 5, 9), ("pair", "object", "parameter")) == (1, 5, 9)
    assert chunk_shape((480, 854, 2), ("y", "x", "uv")) == (480, 854, 2)
    assert chunk_shape((7, 40), ("frame", "object")) == (7, 40)
    assert chunk_shape((0, 4, 4), ("frame", "y", "x")) == (1, 4, 4)
    assert chunk_shape((0, 4), ("track", "xy")) == (1, 4)
    assert chunk_shape((), ()) == ()


def test_metadata_names_axes_and_ends_with_the_checksum():
    files, _ = encode_group({"flow": np.zeros((4, 5, 2), np.float32)}, {"flow": ("y", "x", "uv")})
    metadata = json.loads(bytes(files["flow/zarr.json"]))
    assert metadata["zarr_format"] == 3 and metadata["dimension_names"] == ["y", "x", "uv"]
    assert [codec["name"] for codec in metadata["codecs"]] == ["bytes", "blosc", "crc32c"]


def test_equal_arrays_give_equal_files():
    arrays = {"b": np.arange(5), "a": np.ones((2, 3, 4), np.float32)}
    dims = {"a": ("frame", "y", "x"), "b": ("object",)}
    first, second = encode_group(arrays, dims)[0], encode_group(dict(reversed(arrays.items())), dims)[0]
    assert stored_bytes(first) == stored_bytes(second)


@pytest.mark.parametrize("dims", [("frame", "y", "x"), ("y", "x", "uv")])
@pytest.mark.parametrize("dtype", sorted(DTYPES))
def test_files_are_those_that_zarr_writes(tmp_path: Path, dtype, dims):
    array = np.arange(3 * 40 * 50).reshape(3, 40, 50).astype(dtype)
    files, _ = encode_group({"x": array}, {"x": dims})
    for path, content in stored_bytes(files).items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_bytes(content)
    chunks = [path for path in files if not path.endswith("zarr.json")]
    for path in chunks:
        (tmp_path / path).unlink()
    zarr.open_group(tmp_path, mode="r+")["x"][...] = array
    assert {path: (tmp_path / path).read_bytes() for path in files} == stored_bytes(files)


@settings(max_examples=40, deadline=None)
@given(dtype=st.sampled_from(sorted(DTYPES)), shape=SHAPES, axes=AXES)
def test_metadata_is_that_which_zarr_writes_for_the_shape(dtype, shape, axes):
    dims, dtype = axes[: len(shape)], np.dtype(dtype)
    files, _ = encode_group({"x": np.zeros(shape, dtype)}, {"x": dims})
    name, shuffle = codec._compressor(dtype)
    written: dict = {}
    zarr.create_array(
        zarr.storage.MemoryStore(written),
        name="x",
        shape=shape,
        dtype=dtype,
        chunks=chunk_shape(shape, dims),
        filters=None,
        compressors=[
            zarr.codecs.BloscCodec(cname=name, clevel=1, shuffle=shuffle, typesize=dtype.itemsize),
            zarr.codecs.Crc32cCodec(),
        ],
        chunk_key_encoding={"name": "default", "separator": "."},
        dimension_names=dims,
    )
    assert bytes(files["x/zarr.json"]) == written["x/zarr.json"].to_bytes()


@pytest.mark.parametrize("compressor", [("lz4", "shuffle"), ("zstd", "bitshuffle")])
def test_arrays_of_earlier_versions_are_decoded_without_zarr(monkeypatch, compressor):
    array = np.arange(24.0).reshape(2, 3, 4)
    with monkeypatch.context() as earlier:
        earlier.setattr(codec, "_compressor", lambda dtype: compressor)
        files, (entry,) = encode_group({"x": array}, {"x": ("frame", "y", "x")})
    assert compressor[0].encode() in bytes(files["x/zarr.json"])
    encode_group({"x": array}, {"x": ("frame", "y", "x")})
    monkeypatch.setattr(codec, "run_inline", None)
    assert np.array_equal(decode(entry, stored_bytes(files)), array)


def test_metadata_with_another_spelling_is_read_by_zarr():
    array = np.arange(24.0).reshape(2, 3, 4)
    files, (entry,) = encode_group({"x": array}, {"x": ("frame", "y", "x")})
    respelt = stored_bytes(files) | {"x/zarr.json": json.dumps(json.loads(bytes(files["x/zarr.json"]))).encode()}
    assert respelt != stored_bytes(files)
    assert np.array_equal(decode(entry, respelt), array) and np.array_equal(
        decode(entry, respelt, slice(1, 2)), array[1:]
    )
    with pytest.raises(ValueError, match="where the manifest has"):
        decode(entry.model_copy(update={"dtype": "<i8"}), respelt)


def test_a_chunk_of_another_array_is_refused():
    files, (entry,) = encode_group({"x": np.arange(24.0)}, {"x": ("a",)})
    longer, _ = encode_group({"x": np.arange(25.0)}, {"x": ("a",)})
    with pytest.raises(ValueError, match="200 bytes"):
        decode(entry, stored_bytes(files) | {"x/c.0": bytes(longer["x/c.0"])})


def test_zarr_alone_reads_an_artifact(store, put_toy):
    ref = put_toy(store)
    group = zarr.open_group(store.place(ref), mode="r")
    assert group["x"].nchunks == group["x"].nchunks_initialized == 1
    assert np.array_equal(group["x"][...], store.read(ref, "x"))
    assert group["x"].metadata.dimension_names == ("a", "b")
