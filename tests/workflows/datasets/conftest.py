"""Small data sets on disk."""

import cv2
import numpy as np
import pytest


@pytest.fixture
def write_png():
    """Return a function that writes a PNG or, by its name, a JPEG of one value, 6x4 px by default."""

    def write(path, value=0, size=(4, 6)):
        path.parent.mkdir(parents=True, exist_ok=True)
        cv2.imencode(path.suffix, np.full(size, value, np.uint8))[1].tofile(path)

    return write


@pytest.fixture
def write_sequence(write_png):
    """Return a function that writes frames, and masks of some frames with values by frame number."""

    def write(frames, masks, values, num_frames=3, suffix=".jpg"):
        for number in range(num_frames):
            write_png(frames / f"{number:05d}{suffix}", 100)
        for number, value in values.items():
            write_png(masks / f"{number:05d}.png", value)

    return write
