"""A rendered disc that moves over a textured background, with its exact flow."""

from typing import NamedTuple

import cv2
import numpy as np
import pytest

SHAPE = (96, 160)
RADIUS = 16


class DiscScene(NamedTuple):
    """Frames, the disc in each, and the exact flow of neighbouring frames."""

    frames: list[np.ndarray]
    discs: list[np.ndarray]
    forward: list[np.ndarray]
    backward: list[np.ndarray]


def _render(num_frames=12, speed=(4, 1), start=(30, 40), bar=None, same_colour=False):
    """Render a disc that moves by `speed` px/frame from `start` (xy), behind a static `bar` of columns (x0, x1)."""
    rng = np.random.default_rng(0)

    def texture(colour):
        noise = cv2.GaussianBlur(rng.normal(size=(*SHAPE, 3)), (0, 0), 1.5)
        return colour + 60 * noise

    background = texture((90, 120, 90))
    surface = texture((90, 120, 90) if same_colour else (190, 70, 60))
    frames, discs, velocities = [], [], []
    for t in range(num_frames):
        x, y = start[0] + speed[0] * t, start[1] + speed[1] * t
        rows, columns = np.ogrid[: SHAPE[0], : SHAPE[1]]
        disc = (columns - x) ** 2 + (rows - y) ** 2 <= RADIUS**2
        moved = np.roll(surface, (speed[1] * t, speed[0] * t), axis=(0, 1))
        frame = np.where(disc[..., None], moved, background)
        if bar is not None:
            frame[:, bar[0] : bar[1]] = (
                texture((60, 60, 200))[:, bar[0] : bar[1]] if t == 0 else frames[0][:, bar[0] : bar[1]]
            )
            disc[:, bar[0] : bar[1]] = False
        frames.append(np.clip(np.rint(frame), 0, 255).astype(np.uint8))
        discs.append(disc)
        velocities.append(np.where(disc[..., None], np.float32(speed), np.float32(0)))
    return DiscScene(frames, discs, velocities[:-1], [-velocity for velocity in velocities[1:]])


@pytest.fixture(scope="session")
def render():
    """Return the function that renders a scene."""
    return _render


@pytest.fixture(scope="session")
def iou():
    """Return the function from two masks to their intersection over union."""
    return lambda mask0, mask1: (mask0 & mask1).sum() / (mask0 | mask1).sum()
