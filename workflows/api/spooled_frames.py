"""Frames that were given as arrays, kept in a file that worker processes read."""

import os
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from moseg.schemas.digests import digest_json, hash_array
from moseg.schemas.errors import InputError, StoreError
from moseg.workflows.sources.frames import FrameDescription
from moseg.workflows.sources.resize import shrink_to, working_size

READING_VERSION = 1
"""Raised when `SpooledFrames.read` starts to yield other pixels for the same arrays."""
ACCEPTED = "uint8 (y, x, 3) RGB or (y, x) grey, 0..255"


@dataclass(frozen=True)
class SpooledFrames:
    """Frames `start` to `stop` of a file of raw pixels, as analysed.

    Attributes
    ----------
    path : str
    start, stop : int
    analysed : (int, int)
        Height and width of the frames in the file, px.
    size : (int, int)
        Height and width of the frames as given, px.
    """

    path: str
    start: int
    stop: int
    analysed: tuple[int, int]
    size: tuple[int, int]

    def fingerprint(self) -> str:
        """Return the digest of the pixels."""
        frames = [hash_array(frame) for frame in self.read()]
        return digest_json("source", ["arrays", READING_VERSION, self.size, frames])

    def read(self) -> Iterator[np.ndarray]:
        """Yield each frame as uint8 (y, x, 3) RGB, in order."""
        shape = (*self.analysed, 3)
        count = int(np.prod(shape))
        with open(self.path, "rb") as file:
            file.seek(self.start * count)
            for _ in range(self.start, self.stop):
                yield np.frombuffer(file.read(count), np.uint8).reshape(shape)

    def describe(self) -> FrameDescription:
        """Return the size as given; arrays have no frame rate."""
        return FrameDescription(self.size, None)

    def num_frames(self) -> int:
        """Return how many frames `read` yields."""
        return self.stop - self.start

    def chunks(self, size: int) -> tuple["SpooledFrames", ...]:
        """Return runs of at most `size` frames."""
        starts = range(self.start, self.stop, size)
        return tuple(replace(self, start=start, stop=min(start + size, self.stop)) for start in starts)


@contextmanager
def spool_frames(frames: Iterable, max_side: int) -> Iterator[SpooledFrames]:
    """Write frames to a temporary file, reduced to `max_side` as those of a video are, for the length of the block.

    One frame is in memory at a time, and workers read frames from the file.

    Raises
    ------
    InputError
        There is no frame, or one is not uint8, neither RGB nor grey, or of another size than the first.
    StoreError
        The file cannot be written.
    """
    with _blame_storage("the folder of temporary files"):
        folder = tempfile.TemporaryDirectory(prefix="moseg-", ignore_cleanup_errors=True)
    with folder:
        yield _write_frames(frames, os.path.join(folder.name, "frames.rgb"), max_side)


def _write_frames(frames: Iterable, path: str, max_side: int) -> SpooledFrames:
    """Write the frames to a file; errors of the caller's own iteration are not changed."""
    size, number = None, 0
    for given in frames:
        frame = check_frame(given, number)
        size = size or frame.shape[:2]
        if frame.shape[:2] != size:
            got, expected = (f"{shape[1]}x{shape[0]} px" for shape in (frame.shape, size))
            expected = f"{expected} as the first"
            raise InputError("frame of another size", where=f"frame {number}", got=got, expected=expected)
        analysed = working_size(size, max_side)
        with _blame_storage(path), open(path, "ab") as file:
            file.write(np.ascontiguousarray(shrink_to(frame, analysed)).data)
        number += 1
    if size is None:
        raise InputError("no frame in the video", got="nothing to iterate over", expected="at least 2 frames")
    return SpooledFrames(path, 0, number, analysed, size)


@contextmanager
def _blame_storage(where: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise StoreError("cannot keep the frames", where=where, got=error.strerror or error) from error


def check_frame(given: object, number: int) -> np.ndarray:
    """Return a frame as uint8 (y, x, 3) RGB, grey as three equal channels; raises InputError on anything else."""
    where = f"frame {number}"
    try:
        frame = np.asarray(given)
    except (TypeError, ValueError) as error:
        raise InputError("not a frame", where=where, got=type(given).__name__, expected=ACCEPTED) from error
    if frame.dtype != np.uint8:
        raise InputError("frame of unusable samples", where=where, got=frame.dtype, expected=ACCEPTED)
    is_grey = frame.ndim == 2
    if not (is_grey or (frame.ndim == 3 and frame.shape[2] == 3)) or frame.size == 0:
        raise InputError("frame of another shape", where=where, got=frame.shape, expected=ACCEPTED)
    return np.repeat(frame[..., None], 3, axis=2) if is_grey else frame
