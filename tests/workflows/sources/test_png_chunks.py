"""PNGs whose chunks claim more than the file holds, or hide how large the picture is."""

import struct

import cv2
import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.workflows.sources.png_file import check_png, decode_png

LENGTH_OF_SECOND_CHUNK = 33


def test_a_chunk_of_two_gigabytes_is_refused_before_memory_is_allocated():
    image = np.random.default_rng(0).integers(0, 256, (24, 32, 3), dtype=np.uint8)
    content = bytearray(cv2.imencode(".png", image)[1].tobytes())
    check_png(bytes(content), "a.png", "image")
    content[LENGTH_OF_SECOND_CHUNK : LENGTH_OF_SECOND_CHUNK + 4] = struct.pack(">I", 2130771968)
    for read in (check_png, decode_png):
        with pytest.raises(InputError, match=r"cannot be decoded in a\.png; got a chunk of 2130771968 bytes"):
            read(bytes(content), "a.png", "image")


def test_a_png_that_begins_with_another_chunk_is_refused_before_memory_is_allocated():
    image = np.zeros((24, 32, 3), np.uint8)
    content = bytearray(cv2.imencode(".png", image)[1].tobytes())
    content[12:16] = b"sBIT"
    for read in (check_png, decode_png):
        with pytest.raises(InputError, match=r"cannot be decoded in a\.png; got b'sBIT'; expected b'IHDR'"):
            read(bytes(content), "a.png", "image")
