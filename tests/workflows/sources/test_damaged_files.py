"""Whatever bytes a file of cues holds, it is read or refused by its name."""

import io
import struct
import warnings
import zlib

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from moseg.schemas.errors import InputError
from moseg.workflows.sources.depth_files import decode_depth
from moseg.workflows.sources.flow_files import decode_flow
from moseg.workflows.sources.image_files import decode_image
from moseg.workflows.sources.mask_files import decode_mask
from moseg.workflows.sources.track_files import decode_tracks

RNG = np.random.default_rng(0)
FLOW = RNG.normal(0, 5, (4, 6, 2)).astype(np.float32)
IDS = RNG.integers(0, 4, (4, 6))
TRACKS = {"points": RNG.uniform(0, 4, (3, 5, 2)), "visible": np.ones((3, 5), bool)}


def _saved(save, *arrays, **named):
    content = io.BytesIO()
    save(content, *arrays, **named)
    return content.getvalue()


def _png(values):
    return cv2.imencode(".png", values)[1].tobytes()


def _palette():
    image = Image.fromarray(IDS.astype(np.uint8)).convert("P")
    image.putpalette([0, 0, 0, 9, 9, 9] * 128)
    return _saved(lambda stream: image.save(stream, "PNG", transparency=2))


def _decode_instances(content, path):
    return decode_mask(content, path, "instance")


FILES = {
    "flow.npy": (decode_flow, _saved(np.save, FLOW)),
    "flow.flo": (decode_flow, b"PIEH" + struct.pack("<ii", 6, 4) + FLOW.tobytes()),
    "flow.png": (decode_flow, _png((IDS[..., None] + [1, 2, 3]).astype(np.uint16))),
    "depth.npy": (decode_depth, _saved(np.save, FLOW[..., 0].astype(float))),
    "depth.png": (decode_depth, _png(IDS.astype(np.uint16))),
    "stored.npz": (decode_tracks, _saved(np.savez, **TRACKS)),
    "deflated.npz": (decode_tracks, _saved(np.savez_compressed, **TRACKS)),
    "palette.png": (_decode_instances, _palette()),
    "frame.png": (decode_image, _png(IDS.astype(np.uint8))),
    "mask.png": (_decode_instances, _png(IDS.astype(np.uint16))),
}

damages = st.lists(st.tuples(st.integers(0, 200), st.integers(0, 7)), min_size=1, max_size=4)


def _mend_checksums(png):
    """Return the PNG with right checksums, so that decoders read its chunks."""
    png, start = bytearray(png), 8
    while start + 12 <= len(png):
        end = start + 8 + int.from_bytes(png[start : start + 4], "big")
        if end + 4 > len(png):
            break
        png[end : end + 4] = zlib.crc32(png[start + 4 : end]).to_bytes(4, "big")
        start = end + 4
    return bytes(png)


def _assert_read_or_refused(name, content):
    decode, _ = FILES[name]
    try:
        decode(content, f"/cues/{name}")
    except InputError as error:
        message = str(error)
    else:
        return
    assert f"/cues/{name}" in message


@pytest.mark.parametrize("name", FILES)
def test_the_files_to_be_damaged_are_sound(name):
    decode, content = FILES[name]
    decode(content, name)


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=60, deadline=None)
@given(flips=damages, is_mended=st.booleans())
def test_flipped_bits_are_read_or_refused_by_name(name, flips, is_mended):
    content = bytearray(FILES[name][1])
    for position, bit in flips:
        content[position % len(content)] ^= 1 << bit
    _assert_read_or_refused(name, _mend_checksums(content) if is_mended and name.endswith("png") else bytes(content))


@pytest.mark.parametrize("name", FILES)
@settings(max_examples=30, deadline=None)
@given(kept=st.floats(0, 1), more=st.binary(max_size=20))
def test_files_cut_short_are_read_or_refused_by_name(name, kept, more):
    content = FILES[name][1]
    _assert_read_or_refused(name, content[: int(kept * len(content))] + more)


@pytest.mark.parametrize("side", [9_000, 30_000, 100_000, 2**31 - 1])
@pytest.mark.parametrize("name", [name for name in FILES if name.endswith("png")])
def test_an_image_that_claims_to_be_huge_is_refused_before_memory_is_allocated(name, side):
    decode, content = FILES[name]
    claimed = _mend_checksums(content[:16] + struct.pack(">II", side, side) + content[24:])
    with pytest.raises(InputError, match=rf"cannot be decoded in {name}; got \d+ bytes for {side}x{side} px"):
        decode(claimed, name)


def _grey_png(width, height, num_rows, bits=8):
    """Return a PNG of small values that holds only the bytes of `num_rows` rows of 8 bits."""
    rows = np.random.default_rng(0).integers(0, 2, (num_rows, width + 1), np.uint8)
    rows[:, 0] = 0
    pixels = zlib.compress(rows, 1)
    chunks = (b"IHDR", struct.pack(">IIBBBBB", width, height, bits, 0, 0, 0, 0)), (b"IDAT", pixels), (b"IEND", b"")
    parts = (struct.pack(">I", len(data)) + kind + data + bytes(4) for kind, data in chunks)
    return _mend_checksums(b"\x89PNG\r\n\x1a\n" + b"".join(parts))


def test_a_large_mask_that_holds_less_than_it_claims_is_refused():
    assert decode_mask(_grey_png(5000, 4000, 4000), "a.png", "instance").shape == (4000, 5000)
    with pytest.raises(
        InputError, match=r"decoded in a\.png; got 5001000 bytes of samples; expected 20000000 for 5000x"
    ):
        decode_mask(_grey_png(5000, 4000, 1000), "a.png", "instance")


def test_a_large_picture_that_holds_far_less_than_it_claims_is_refused():
    assert decode_image(_grey_png(5000, 4000, 4000), "a.png").shape == (4000, 5000, 3)
    with pytest.raises(InputError, match=r"image cannot be decoded in a\.png; got 500100 bytes of samples"):
        decode_image(_grey_png(5000, 4000, 100), "a.png")


def test_a_mask_beyond_any_size_is_refused_before_it_is_unpacked():
    with pytest.raises(InputError, match=r"mask of too many pixels in a\.png; got 20000x20000 px"):
        decode_mask(_grey_png(20000, 20000, 500), "a.png", "instance")


@pytest.mark.parametrize("decode", [decode_image, decode_flow, decode_depth, _decode_instances])
def test_a_png_of_one_bit_that_holds_less_than_it_claims_is_refused_before_it_is_expanded(decode):
    with pytest.raises(InputError, match=r"cannot be decoded in a\.png; got 1638500 bytes of samples; expected 1677"):
        decode(_grey_png(16384, 8192, 100, bits=1), "a.png")


@pytest.mark.parametrize("damage", ["checksum", "pixels", "header"])
@pytest.mark.parametrize("name", [name for name in FILES if name.endswith("png")])
def test_a_damaged_png_prints_nothing(name, damage, capfd):
    decode, content = FILES[name]
    if damage == "header":
        content = content[:24] + b"\x03" + content[25:]
    else:
        place = content.index(b"IDAT") + 8
        content = content[:place] + bytes([content[place] ^ 0x55]) + content[place + 1 :]
    with pytest.raises(InputError, match=f"decoded in {name}"):
        decode(content if damage == "checksum" else _mend_checksums(content), name)
    assert capfd.readouterr() == ("", "")


def test_a_mask_with_parts_of_an_animation_is_read_without_output():
    png = _png(IDS.astype(np.uint16))
    odd = _mend_checksums(png[:33] + struct.pack(">I4sIII", 8, b"acTL", 0, 0, 0) + png[33:])
    np.testing.assert_array_equal(decode_mask(odd, "a.png", "instance"), IDS)


def test_a_header_that_is_almost_python_is_refused_without_output():
    content = FILES["depth.npy"][1]
    shape = content[content.index(b"'shape'") : content.index(b"}")]
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        with pytest.raises(InputError, match=r"cannot be decoded in a\.npy"):
            decode_depth(content.replace(shape, b"'shape': 4in".ljust(len(shape))), "a.npy")
    assert not said


@pytest.mark.parametrize("name", ["flow.npy", "depth.npy"])
def test_an_array_that_claims_to_be_huge_is_named(name):
    decode, content = FILES[name]
    shape = content[content.index(b"'shape'") : content.index(b"}")]
    claimed = b"'shape': (1000000, 1000000, 2)"
    padded = content.replace(shape, claimed).replace(b" " * (len(claimed) - len(shape)) + b"\n", b"\n")
    assert len(padded) == len(content)
    with pytest.raises(InputError, match=rf"cannot be decoded in {name}; .* shape \(1000000, 1000000, 2\)"):
        decode(padded, name)


def test_signalling_nans_are_refused_without_a_warning():
    depth = FLOW[..., 0].astype(float)
    depth.view(np.uint64)[0, 0] = 0x7FF0000000000001
    with pytest.raises(InputError, match=r"not finite in a\.npy; got 1 "):
        decode_depth(_saved(np.save, depth), "a.npy")
    with pytest.raises(InputError, match=r"not finite in a\.npy; got 2 "):
        decode_flow(_saved(np.save, np.dstack([depth, depth])), "a.npy")
