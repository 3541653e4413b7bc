"""Sources of frames from whatever a caller gives as a video."""

import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.api.spooled_frames import spool_frames
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.sources import open_frames

VideoLike = str | os.PathLike | np.ndarray | Iterable[np.ndarray]
"""Path of a video file or of a folder of frames; array uint8 (frame, y, x, 3) RGB or (frame, y, x) grey; or frames one
by one, uint8 (y, x, 3) or (y, x)."""
ACCEPTED = "a path, an array (frame, y, x, 3) RGB or (frame, y, x) grey, or frames one by one"


@contextmanager
def open_video(video: VideoLike, name: str | None, max_side: int) -> Iterator[SequenceSource]:
    """Open a video as a source for the block; raises InputError where it cannot be read as one."""
    if isinstance(video, str | os.PathLike):
        path = os.fsdecode(video)
        if not path.strip():
            raise InputError("no video named", got=repr(path), expected="a video file, or a folder of frames")
        yield SequenceSource(name or Path(path).resolve().stem, open_frames(path, max_side))
        return
    _check(video)
    with spool_frames(video, max_side) as frames:
        yield SequenceSource(name or "frames", frames)


def _check(video: object) -> None:
    """Raise InputError where something cannot be a sequence of frames as a whole."""
    if isinstance(video, bytes) or not isinstance(video, Iterable):
        raise InputError("not a video", got=type(video).__name__, expected=ACCEPTED)
    if not isinstance(video, np.ndarray):
        return
    if video.dtype != np.uint8:
        raise InputError("array of unusable samples", got=video.dtype, expected="uint8, 0..255")
    # No video is one, three or four pixels wide: it is one image. An array of three or four planes may be one, too.
    if video.ndim == 3 and (video.shape[2] in (1, 3, 4) or video.shape[0] in (3, 4)):
        expected = f"{ACCEPTED}; list(array) where these are grey frames"
        raise InputError("an array that may be one image", got=video.shape, expected=expected)
    if video.ndim not in (3, 4):
        raise InputError("not the array of a video", got=video.shape, expected=ACCEPTED)
