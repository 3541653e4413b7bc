"""Textured images that move by a known amount."""

import cv2
import numpy as np
import pytest

HEIGHT, WIDTH = 120, 180


@pytest.fixture(scope="session")
def texture():
    """A smooth random texture larger than a frame, uint8 (y, x, 3)."""
    noise = np.random.default_rng(0).integers(0, 256, (HEIGHT + 120, WIDTH + 120, 3)).astype(np.float32)
    smooth = cv2.GaussianBlur(noise, (0, 0), 2)
    spread = (smooth - smooth.mean()) / smooth.std()
    return np.clip(128 + 40 * spread, 0, 255).astype(np.uint8)


@pytest.fixture
def drift(texture):
    """Function that cuts frames out of the texture so that its content moves by `step` px/frame."""

    def build(num_frames, step=(1.25, -0.75)):
        frames = []
        for index in range(num_frames):
            x, y = 60 - index * step[0], 60 - index * step[1]
            cut = np.array([[1.0, 0, x], [0, 1.0, y]])
            flags = cv2.INTER_CUBIC | cv2.WARP_INVERSE_MAP
            frames.append(cv2.warpAffine(texture, cut, (WIDTH, HEIGHT), flags=flags))
        return frames

    return build


@pytest.fixture
def square():
    """Function that draws an object (1) into an empty mask."""

    def build(x0, y0, side=40, label=1):
        mask = np.zeros((HEIGHT, WIDTH), np.uint16)
        mask[y0 : y0 + side, x0 : x0 + side] = label
        return mask

    return build
