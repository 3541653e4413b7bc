"""Choice of frames of a video: from where, up to where, and how many of them."""

import math
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

from moseg.schemas.errors import InputError

POSITIONS = "a frame counted from 0 (120), seconds (4.5s) or a timecode (0:04.5)"
STEPS = "a number of frames (5) or seconds (0.5s)"
TOLERANCE_SEC = 1e-6
"""Time stamps are rounded to the container's units, and decimal seconds to binary ones."""
_FRAME = re.compile(r"[0-9]{1,9}")
_SECONDS = re.compile(r"([0-9]{1,9}(?:\.[0-9]+)?) ?s")
_TIMECODE = re.compile(r"(?:([0-9]{1,6}):)?([0-9]{1,6}):([0-9]{1,2}(?:\.[0-9]+)?)")


class Position(NamedTuple):
    """A frame of a video, counted from 0, or a time in seconds since its first frame; or a distance in either."""

    value: float
    is_time: bool

    def is_reached(self, number: int, time_sec: float) -> bool:
        """Return whether a frame is at this position or after it."""
        return time_sec >= self.value - TOLERANCE_SEC if self.is_time else number >= self.value


def read_position(text: str | int, where: str, expected: str = POSITIONS) -> Position:
    """Return a position given in words: ``120`` is a frame, ``4.5s`` and ``0:04.5`` are times.

    Raises
    ------
    InputError
        It is neither, or it might be either, as ``4.5``.
    """
    words = str(text).strip()
    if _FRAME.fullmatch(words):
        return Position(int(words), False)
    if seconds := _SECONDS.fullmatch(words):
        return Position(float(seconds[1]), True)
    if code := _TIMECODE.fullmatch(words):
        return Position((int(code[1] or 0) * 60 + int(code[2])) * 60 + float(code[3]), True)
    raise InputError("neither a frame nor a time", where=where, got=repr(text), expected=expected)


def read_step(text: str | int, where: str) -> Position:
    """Return a distance between frames; raises InputError where it is neither a number nor a time, or is 0."""
    step = read_position(text, where, STEPS)
    if step.value <= 0:
        raise InputError("no step", where=where, got=repr(text), expected=f"{STEPS} above 0")
    return step


@dataclass(frozen=True)
class FrameRange:
    """The frames from `start` to `end`, which is left out, and of these only each that is `every` further.

    Attributes
    ----------
    start, end, every : Position or None
        From the first frame, to the last, and all of them, where None.
    """

    start: Position | None = None
    end: Position | None = None
    every: Position | None = None

    @property
    def is_whole(self) -> bool:
        """Return whether all frames are chosen."""
        return self == FrameRange()

    @property
    def has_times(self) -> bool:
        """Return whether frames are chosen by their times."""
        return any(each is not None and each.is_time for each in (self.start, self.end, self.every))

    def choose(self, times_sec: Iterable[float]) -> Iterator[int]:
        """Yield the numbers of the chosen frames, given each frame's time; no time is drawn beyond the end."""
        first, num_steps = None, 0
        for number, time in enumerate(times_sec):
            if self.end is not None and self.end.is_reached(number, time):
                return
            if self.start is not None and not self.start.is_reached(number, time):
                continue
            if first is None:
                first = number
                origin = self.start.value if self.start is not None and self.start.is_time else time
            if self.every is None:
                yield number
            elif not self.every.is_time:
                if (number - first) % self.every.value == 0:
                    yield number
            elif time >= origin + num_steps * self.every.value - TOLERANCE_SEC:
                yield number
                num_steps = int((time - origin + TOLERANCE_SEC) // self.every.value) + 1

    def thinned_rate(self, fps: float) -> float:
        """Return the frames per second of what is chosen, so that it plays as fast as the whole."""
        if self.every is None:
            return fps
        return min(fps, 1 / self.every.value) if self.every.is_time else fps / self.every.value


class Seen:
    """Times that are drawn one by one, and what was seen of them.

    Attributes
    ----------
    count : int
    last : float
        NaN before the first.
    is_at_end : bool
        Whether there are no more.
    """

    def __init__(self, times_sec: Iterable[float]):
        self._times = times_sec
        self.count, self.last, self.is_at_end = 0, math.nan, False

    def __iter__(self) -> Iterator[float]:
        for time in self._times:
            self.count, self.last = self.count + 1, time
            yield time
        self.is_at_end = True


WHOLE = FrameRange()


def read_frame_range(
    start: str | int | None = None, end: str | int | None = None, every: str | int | None = None
) -> FrameRange:
    """Return the range that the options `--start`, `--end` and `--every` name.

    Raises
    ------
    InputError
        One is neither a frame nor a time, the end is not after the start, or the step is 0.
    """
    first = None if start is None else read_position(start, "--start")
    last = None if end is None else read_position(end, "--end")
    step = None if every is None else read_step(every, "--every")
    earliest = first or Position(0, last is not None and last.is_time)
    if last is not None and last.is_time == earliest.is_time and last.value <= earliest.value:
        raise InputError("no frame chosen", where="--end", got=repr(end), expected="an end after the start")
    return FrameRange(first, last, step)
