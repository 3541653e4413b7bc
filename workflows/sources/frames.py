"""What every source of frames offers, and the frame rate that counts."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol

import numpy as np

from moseg.schemas.errors import InputError

DEFAULT_FPS = 24.0
"""Frames per second of frames that come without a rate: a folder of images, arrays."""
SLOWEST_FPS, FASTEST_FPS = 0.1, 1000.0
"""Frames per second: a time lapse of ten seconds a frame, and a high-speed camera."""


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


def check_fps(fps: float, where: str) -> None:
    """Raise InputError, naming the argument `where`, on a rate beyond what an overlay is made for; also on NaN."""
    if not SLOWEST_FPS <= fps <= FASTEST_FPS:
        expected = f"{SLOWEST_FPS:g}..{FASTEST_FPS:g} frames per second"
        raise InputError("not a frame rate", where=where, got=fps, expected=expected)


def choose_fps(asked: float | None, own: float | None) -> float:
    """Frames per second of the results: the rate asked for, else the video's own, else `DEFAULT_FPS`."""
    return float(asked or own or DEFAULT_FPS)
