"""The interface of every source of frames."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol

import numpy as np


class FrameDescription(NamedTuple):
    """Original (height, width) of the frames in px, before any reduction, and frames per second where known."""

    size: tuple[int, int]
    fps: float | None


class FrameSource(Protocol):
    """Frames of one sequence, all of one size."""

    def fingerprint(self) -> str:
        """Return the digest of everything on which `read` depends; file names and times do not count."""

    def read(self) -> Iterator[np.ndarray]:
        """Yield each frame as uint8 (y, x, 3) RGB, in order."""

    def describe(self) -> FrameDescription:
        """Return the original size and the frame rate."""

    def num_frames(self) -> int:
        """Return how many frames `read` yields; a video is decoded for it, since its header may be wrong."""

    def chunks(self, size: int) -> tuple["FrameSource", ...]:
        """Return sources of at most `size` frames that can be read in parallel; one source if that is impossible."""
