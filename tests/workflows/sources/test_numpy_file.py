"""Arrays are read as numpy reads them, and nothing that a file claims is believed before it is checked."""

import io
import tracemalloc
import zipfile

import numpy as np
import pytest
from numpy.lib import format as npy_format

from moseg.schemas.errors import InputError
from moseg.workflows.sources.numpy_file import decode_array, decode_arrays

VALUES = np.arange(24.0).reshape(4, 6)
ARRAYS = [
    VALUES,
    np.asfortranarray(VALUES),
    VALUES.astype(">f4"),
    VALUES > 3,
    VALUES[:0],
    np.asfortranarray(VALUES[:, :0]),
    np.float16(3.5),
    np.zeros((2, 3), [("u", "<f4"), ("v", "<i8")]),
    np.array(["one", "three"]),
]


def save(array, version=None):
    content = io.BytesIO()
    npy_format.write_array(content, np.asanyarray(array), version)
    return content.getvalue()


def with_header(text, version=(1, 0), values=b"\0" * 64):
    start = npy_format.magic(*version)
    return start + len(text).to_bytes(2 if version == (1, 0) else 4, "little") + text.encode("latin-1") + values


def claim(shape, descr="'<f8'"):
    return with_header(f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}}}")


def archive(**members):
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as written:
        for name, member in members.items():
            written.writestr(f"{name}.npy", member)
    return content.getvalue()


@pytest.mark.parametrize("version", [(1, 0), (2, 0), (3, 0)])
@pytest.mark.parametrize("array", ARRAYS, ids=lambda array: f"{array.dtype.kind}-{array.shape}")
def test_arrays_are_those_that_numpy_reads(array, version):
    content = save(array, version)
    expected = np.load(io.BytesIO(content), allow_pickle=False)
    # More arrays may follow in a file.
    for found in (decode_array(content, "a.npy", "map"), decode_array(content + content, "a.npy", "map")):
        assert (found.dtype, found.shape, found.strides) == (expected.dtype, expected.shape, expected.strides)
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("save_archive", [np.savez, np.savez_compressed])
def test_arrays_of_archives_are_those_that_were_saved(save_archive):
    content = io.BytesIO()
    save_archive(content, **{f"a{number}": array for number, array in enumerate(ARRAYS)})
    for number, array in enumerate(ARRAYS):
        (found,) = decode_arrays(content.getvalue(), (f"a{number}",), "a.npz", "tracks")
        np.testing.assert_array_equal(found, array)


@pytest.mark.parametrize(
    "content",
    [
        claim("(1000000, 1000000, 2)"),
        claim("(9,)"),
        claim("(-1, 3)"),
        claim(f"(0, {2**70})"),
        claim("(2,) * 3"),
        claim("(" * 2000),
        claim(f"({'-' * 9000}1,)"),
        claim("(1L, 2"),
        claim("(1,)", "'|O'"),
        claim("(1,)", "('<f8', (1000000000,))"),
        claim("(1,)", "[('a',)]"),
        claim("(1,)", "7"),
        claim("(1,)", "{'names': 3}"),
        with_header("'''"),
        with_header("  {\n {"),
        with_header("\0"),
        with_header("{" + " " * 20000 + "}"),
        npy_format.magic(2, 0) + b"\xff\xff\xff\xff" + b" " * 100,
        npy_format.magic(9, 0) + b"\x10\0" + b" " * 100,
        save(VALUES)[:-1],
        save(VALUES)[:50],
        save(VALUES)[:7],
        b"text",
        b"",
    ],
    ids=lambda content: repr(content[:70]),
)
def test_a_file_that_cannot_be_an_array_is_named_before_memory_is_allocated(content):
    tracemalloc.start()
    try:
        with pytest.raises(InputError, match=r"map cannot be decoded in a\.npy; got "):
            decode_array(content, "a.npy", "map")
        with pytest.raises(InputError, match=r"cannot be decoded in a\.npz; got "):
            decode_arrays(archive(points=content), ("points",), "a.npz", "tracks")
        assert tracemalloc.get_traced_memory()[1] < 2**24
    finally:
        tracemalloc.stop()


def test_a_long_header_is_not_repeated_in_its_error():
    with pytest.raises(InputError) as raised:
        decode_array(with_header("[" + "0, " * 3000 + "]"), "a.npy", "map")
    assert len(str(raised.value)) < 300


def test_members_that_are_not_arrays_and_absent_ones_are_named():
    with pytest.raises(InputError, match=r"tracks: array points cannot be decoded in a\.npz; got .*magic"):
        decode_arrays(archive(points=b"some text"), ("points",), "a.npz", "tracks")
    with pytest.raises(InputError, match=r"in a\.npz; got arrays other\.npy; expected an array points"):
        decode_arrays(archive(other=save(VALUES)), ("points",), "a.npz", "tracks")


def test_an_archive_that_expands_too_much_is_refused_before_it_is_expanded():
    length = 2**28
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", zipfile.ZIP_DEFLATED) as written, written.open("points.npy", "w") as member:
        member.write(claim(f"({length},)", "'|u1'"))
        for _ in range(length // 2**20):
            member.write(bytes(2**20))
    assert len(content.getvalue()) < 2**22
    with pytest.raises(InputError, match=r"in a\.npz; got array points of \d+ bytes in an archive of \d+; .*savez"):
        decode_arrays(content.getvalue(), ("points",), "a.npz", "tracks")
