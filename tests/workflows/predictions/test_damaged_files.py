"""A file of saved masks with any bytes is read or refused by its name."""

import io
import struct
import zipfile
import zlib

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.predictions import FrameList, open_predictions

SHAPE = (4, 6)
LABELS = np.random.default_rng(0).integers(0, 3, (2, *SHAPE)).astype(np.uint8)


def _saved(save, *arrays, **named):
    content = io.BytesIO()
    save(content, *arrays, **named)
    return content.getvalue()


FILES = {
    "volume/dog.npy": _saved(np.save, LABELS),
    "volume/cat.npz": _saved(np.savez_compressed, segmentation=LABELS),
    "volume/cow.npz": _saved(np.savez, LABELS),
    "png/dog/0.png": _saved(lambda stream: Image.fromarray(LABELS[0]).save(stream, "PNG")),
    "em/dog/0_proba.npy": _saved(np.save, np.stack([LABELS[0] / 9, LABELS[1] / 8])),
    "rigidmask/dog/pm-0.pfm": b"Pf\n6 4\n-1\n" + LABELS[0].astype("<f4").tobytes(),
}


def _read(root, file, content):
    path = root / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content)
    format, name = file.split("/")[:2]
    num_frames = 2 if format == "volume" else 1
    sequence = open_predictions(root / format, format).sequence(name.partition(".")[0], FrameList(num_frames), SHAPE)
    return [sequence.frame(index) for index in range(num_frames)]


def _assert_read_or_refused(root, file, content):
    try:
        _read(root, file, content)
    except InputError as error:
        message = str(error)
    else:
        return
    assert str(root / file) in message


def _claim(shape, descr="|u1"):
    header = f"{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}}}".encode()
    return b"\x93NUMPY\1\0" + struct.pack("<H", len(header)) + header + bytes(48)


@pytest.mark.parametrize("file", FILES)
def test_the_files_to_be_damaged_are_sound(tmp_path, file):
    _read(tmp_path, file, FILES[file])


@pytest.mark.parametrize("file", FILES)
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    flips=st.lists(st.tuples(st.integers(0, 400), st.integers(0, 7)), max_size=4),
    kept=st.one_of(st.just(1.0), st.floats(0, 1)),
)
def test_flipped_bits_and_lost_ends_are_read_or_refused_by_name(tmp_path, file, flips, kept):
    content = bytearray(FILES[file])
    for position, bit in flips:
        content[position % len(content)] ^= 1 << bit
    _assert_read_or_refused(tmp_path, file, content[: int(kept * len(content))])


@pytest.mark.parametrize("file", ["volume/dog.npy", "volume/cat.npz", "em/dog/0_proba.npy"])
@pytest.mark.parametrize(
    "content",
    [_claim("(1000000, 1000000, 2)"), _claim("(2, 4, 6)", "|S2000000000"), _claim("(" * 500), b"text"],
    ids=["huge", "long-strings", "no-python", "text"],
)
def test_a_header_that_cannot_be_true_is_named(tmp_path, file, content):
    if file.endswith("npz"):
        archive = io.BytesIO()
        with zipfile.ZipFile(archive, "w") as written:
            written.writestr("segmentation.npy", content)
        content = archive.getvalue()
    with pytest.raises(InputError, match=file.replace(".", r"\.")):
        _read(tmp_path, file, content)


def test_an_archive_in_place_of_layers_is_named(tmp_path):
    with pytest.raises(InputError, match=r"layer probabilities cannot be decoded in .*0_proba\.npy"):
        _read(tmp_path, "em/dog/0_proba.npy", FILES["volume/cow.npz"])


def test_empty_layers_are_named(tmp_path):
    with pytest.raises(InputError, match=r"no layer probabilities in .*0_proba\.npy; got float64 \(0, 4, 6\)"):
        _read(tmp_path, "em/dog/0_proba.npy", _saved(np.save, np.zeros((0, *SHAPE))))


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
def test_layers_that_are_not_finite_are_named(tmp_path, value):
    layers = np.full((2, *SHAPE), 0.5)
    layers[1, 2, 3] = value
    with pytest.raises(InputError, match=r"no layer probabilities in .*0_proba\.npy; got NaN or infinite"):
        _read(tmp_path, "em/dog/0_proba.npy", _saved(np.save, layers))


@pytest.mark.parametrize("side", [9_000, 100_000])
def test_a_label_image_that_claims_to_be_huge_is_named(tmp_path, side):
    png = bytearray(FILES["png/dog/0.png"])
    png[16:24] = struct.pack(">II", side, side)
    png[29:33] = struct.pack(">I", zlib.crc32(png[12:29]))
    with pytest.raises(InputError, match=rf"label image cannot be decoded in .*0\.png; .* {side}x{side} px"):
        _read(tmp_path, "png/dog/0.png", png)
