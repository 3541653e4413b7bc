"""Whatever bytes a file of cues holds, it is read or refused by its name."""

import io
import struct
import zlib

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from schemas.errors import InputError
from workflows.sources.depth_files import decode_depth
from workflows.sources.flow_files import decode_flow
from workflows.sources.mask_files import decode_mask
from workflows.sources.track_files import decode_tracks

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
    "mask.png": (_decode_instances, _png(IDS.astype(np.uint16))),
}

damages = st.lists(st.tuples(st.integers(0, 200), st.integers(0, 7)), min_size=1, max_size=4)


def _mend_checksums(png):
    """The PNG with the checksum of each chunk made right, so that decoders get to see what is in it."""
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
# What numpy and Pillow have to say about odd files that they do read.
@pytest.mark.filterwarnings("ignore::UserWarning", "ignore::SyntaxWarning", "ignore::DeprecationWarning")
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
def test_an_image_that_claims_to_be_huge_is_named_before_memory_is_taken(name, side):
    decode, content = FILES[name]
    claimed = _mend_checksums(content[:16] + struct.pack(">II", side, side) + content[24:])
    with pytest.raises(InputError, match=rf"cannot be decoded in {name}; got \d+ bytes for {side}x{side} px"):
        decode(claimed, name)


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
