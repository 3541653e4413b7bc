"""What every source of frames offers, and the size at which frames are analysed."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol

import cv2
import numpy as np


class FrameDescription(NamedTuple):
    """Original (height, width) of the frames in px, before any reduction, and frames per second where known."""

    size: tuple[int, int]
    fps: float | None


class FrameSource(Protocol):
    """Frames of one sequence, all of one size."""

    def fingerprint(self) -> str:
        """Digest of everything that decides what `read` yields; file names and times are no part of it."""

    def read(self) -> Iterator[np.ndarray]:
        """Each frame as uint8 (y, x, 3) RGB, in order."""

    def describe(self) -> FrameDescription:
        """Original size and frame rate."""

    def num_frames(self) -> int:
        """How many frames `read` yields; a video is decoded for it, since its header may be wrong."""

    def chunks(self, size: int) -> tuple["FrameSource", ...]:
        """Sources of at most `size` frames that can be read in parallel; one source where that cannot be."""


def working_size(size: tuple[int, int], max_side: int) -> tuple[int, int]:
    """(height, width) px of frames of `size` once their longer side is at most `max_side`."""
    longer = max(size)
    if longer <= max_side:
        return size
    return max(1, round(size[0] * max_side / longer)), max(1, round(size[1] * max_side / longer))


def shrink_to(image: np.ndarray, size: tuple[int, int]) -> np.ndarray:
    """The image area-averaged to (height, width) `size`; itself where that is its size."""
    if image.shape[:2] == size:
        return image
    return cv2.resize(image, (size[1], size[0]), interpolation=cv2.INTER_AREA)
