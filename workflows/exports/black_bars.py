"""Black bars around a video's picture, which are analysed as if they were scene."""

import math
from collections.abc import Sequence
from itertools import takewhile
from typing import NamedTuple

import numpy as np

DARK = 24
"""Brightest grey level of a bar."""
RINGING = 0.02
"""Share of a line's pixels, over all frames, that may be brighter: beside the picture, coding leaves traces of it."""
MIN_SHARE = 0.01
"""Share of the frame's side below which the rows or columns of a side are no bar."""
SAMPLES = 8
"""Frames that are compared."""


class BlackBars(NamedTuple):
    """Widths of the bars at the four sides, px; 0 where there is none."""

    left: int
    top: int
    right: int
    bottom: int


def sampled(count: int) -> list[int]:
    """Return the indices of the frames, spread over all `count`, that `find_bars` compares."""
    return sorted({*np.linspace(0, count - 1, min(count, SAMPLES)).round().astype(int).tolist()})


def find_bars(images: Sequence[np.ndarray]) -> BlackBars:
    """Return the bars of frames uint8 (y, x, 3); none in frames that are black all over."""
    rows, columns = (_is_bar(np.moveaxis(np.stack(images), axis, 0)) for axis in (1, 2))
    if rows.all() or columns.all():
        return BlackBars(0, 0, 0, 0)
    (top, bottom), (left, right) = (map(_length, (lines, lines[::-1])) for lines in (rows, columns))
    return BlackBars(left, top, right, bottom)


def describe_bars(bars: BlackBars, analysed: tuple[int, int], shape: tuple[int, int]) -> tuple[str, ...]:
    """Return what is to be done about bars, in one line, or nothing where there are none.

    Parameters
    ----------
    bars : BlackBars
        In frames of the size `analysed` (height, width).
    analysed, shape : (int, int)
        `shape` is the video's own size, which the line speaks of.
    """
    if not any(bars):
        return ()
    (height, width), (down, across) = shape, (size / small for size, small in zip(shape, analysed, strict=True))
    left, right = (_even(side * across) for side in (bars.left, bars.right))
    top, bottom = (_even(side * down) for side in (bars.top, bars.bottom))
    sides = {"left": left, "above": top, "right": right, "below": bottom}
    named = ", ".join(f"{size} px {side}" for side, size in sides.items() if size)
    # Encoders need even sizes.
    kept = f"{(width - left - right) // 2 * 2}:{(height - top - bottom) // 2 * 2}:{left}:{top}"
    told = "count as scene, so that objects may be lost or wrong"
    return (f"black bars ({named}) {told}: cut them off first, as `ffmpeg -i IN -vf crop={kept} OUT` does",)


def _is_bar(lines: np.ndarray) -> np.ndarray:
    """Return which of the lines uint8 (N, ...) are dark everywhere, bool (N,)."""
    return (lines.reshape(len(lines), -1) > DARK).mean(axis=1) <= RINGING


def _length(lines: np.ndarray) -> int:
    """Return how many lines at the beginning are a bar."""
    length = sum(1 for _ in takewhile(bool, lines))
    return length if length >= MIN_SHARE * len(lines) else 0


def _even(size: float) -> int:
    """Return the next even number of pixels."""
    return 2 * math.ceil(round(size, 6) / 2)
