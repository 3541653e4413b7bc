"""Sources of frames from whatever a caller gives as a video."""

import math
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager

import numpy as np

from moseg.schemas.errors import InputError
from moseg.workflows.api.spooled_frames import spool_frames
from moseg.workflows.config.frame_range import WHOLE, FrameRange, Seen
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.sources import ImageFiles, VideoFile, open_frames
from moseg.workflows.sources.files import named_stem
from moseg.workflows.sources.number_gaps import gap_notes

VideoLike = str | os.PathLike | np.ndarray | Iterable[np.ndarray]
"""Path of a video file or of a folder of frames; array uint8 (frame, y, x, 3) RGB or (frame, y, x) grey; or frames one
by one, uint8 (y, x, 3) or (y, x)."""
ACCEPTED = "a path, an array (frame, y, x, 3) RGB or (frame, y, x) grey, or frames one by one"


@contextmanager
def open_video(
    video: VideoLike, name: str | None, max_side: int, chosen: FrameRange = WHOLE, fps: float | None = None
) -> Iterator[SequenceSource]:
    """Open the chosen frames of a video as a source for the block.

    `fps` is the rate of frames without times of their own. InputError is raised where it cannot be read as a video.
    """
    if isinstance(video, str | os.PathLike):
        path = named_video(video)
        whole = open_frames(path, max_side)
        frames = choose_frames(whole, chosen, fps)
        notes = _gap_notes(whole, frames) if isinstance(whole, ImageFiles) else ()
        yield SequenceSource(name or named_stem(path), frames, notes=notes)
        return
    _check(video)
    with spool_frames(_choose(video, chosen, fps), max_side) as frames:
        yield SequenceSource(name or "frames", frames)


def _gap_notes(whole: ImageFiles, chosen: ImageFiles) -> tuple[str, ...]:
    """Return notes on frames that are missing between the first and the last chosen one."""
    start, stop = whole.paths.index(chosen.paths[0]), whole.paths.index(chosen.paths[-1]) + 1
    return gap_notes(whole.paths[start:stop])


def named_video(video: str | os.PathLike) -> str:
    """Return the path of a video; raises InputError if it is blank."""
    path = os.fsdecode(video)
    if not path.strip():
        raise InputError("no video named", got=repr(path), expected="a video file, or a folder of frames")
    return path


def choose_frames(
    frames: ImageFiles | VideoFile, chosen: FrameRange, fps: float | None = None
) -> ImageFiles | VideoFile:
    """Return the source of the chosen frames alone; itself if all are chosen.

    Parameters
    ----------
    frames : ImageFiles or VideoFile
        Of all frames.
    chosen : FrameRange
    fps : float, optional
        Frames per second of images, which have no times of their own.

    Raises
    ------
    InputError
        No frame is chosen, a time is given and images have no rate, or the video cannot be decoded up to the end.
    """
    if chosen.is_whole:
        return frames
    if isinstance(frames, VideoFile):
        where, times = frames.path, frames.times()
    else:
        where = os.path.dirname(frames.paths[0])
        _check_rate(chosen, fps, where)
        times = (number / (fps or math.nan) for number in range(len(frames.paths)))
    seen = Seen(times)
    numbers = tuple(chosen.choose(seen))
    if not numbers:
        raise _nothing_chosen(seen, chosen, where)
    is_whole = seen.is_at_end and numbers == tuple(range(seen.count))
    return frames if is_whole else frames.choose(numbers)


def _nothing_chosen(seen: Seen, chosen: FrameRange, where: str | None) -> InputError:
    last = f", the last one at {seen.last:.3f} s" if chosen.has_times else ""
    expected = "--start and --end within them"
    return InputError("no frame chosen", where=where, got=f"{seen.count} frames{last}", expected=expected)


def _check_rate(chosen: FrameRange, fps: float | None, where: str | None = None) -> None:
    """Raise InputError if frames are chosen by times that they do not have."""
    if chosen.has_times and fps is None:
        raise InputError("a time needs a frame rate", where=where, got="frames without one", expected="--fps")


def _choose(video: Iterable, chosen: FrameRange, fps: float | None) -> Iterable:
    """Yield the chosen ones of frames that are given one by one."""
    if chosen.is_whole:
        yield from video
        return
    _check_rate(chosen, fps)
    # Drawn one ahead by `choose`: each frame is taken when its time is.
    taken = []

    def times() -> Iterator[float]:
        for number, frame in enumerate(video):
            taken[:] = [frame]
            yield number / (fps or math.nan)

    seen = Seen(times())
    is_empty = True
    for _ in chosen.choose(seen):
        is_empty = False
        yield taken[0]
    if is_empty and seen.count:
        raise _nothing_chosen(seen, chosen, None)


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
