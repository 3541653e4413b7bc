"""The interface of every source of frames, and the choice of the frame rate."""

from collections.abc import Iterator
from typing import NamedTuple, Protocol

import numpy as np

from moseg.schemas.errors import InputError

DEFAULT_FPS = 24.0
"""Frames per second of frames without a rate: a folder of images, arrays."""
MIN_FPS, MAX_FPS = 0.1, 1000.0
"""Frames per second: a time lapse of ten seconds a frame, and a high-speed camera."""


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


def check_fps(fps: float, where: str) -> None:
    """Raise InputError, naming the argument `where`, for NaN or a rate that overlays do not support."""
    if not MIN_FPS <= fps <= MAX_FPS:
        expected = f"{MIN_FPS:g}..{MAX_FPS:g} frames per second"
        raise InputError("not a frame rate", where=where, got=fps, expected=expected)


def choose_fps(asked: float | None, own: float | None) -> float:
    """Return the results' frames per second: those requested, else the video's own, else `DEFAULT_FPS`."""
    return float(asked or own or DEFAULT_FPS)
