"""Overlapping windows of a sequence that is read once."""

from collections.abc import Iterable, Iterator
from typing import TypeVar

Item = TypeVar("Item")


def overlapping_windows(items: Iterable[Item], length: int, advance: int) -> Iterator[tuple[int, list[Item]]]:
    """Windows of `length` items that begin at 0, `advance`, 2 `advance`, …, each with the index of its first.

    Items are taken one by one and kept only as long as a window needs them. Every item that a window may begin with
    begins one: the last windows are shorter, as far as the items reach.

    Parameters
    ----------
    items : iterable
    length : int
    advance : int
        At most `length`.
    """
    first = 0
    window: list[Item] = []
    for item in items:
        window.append(item)
        if len(window) == length:
            yield first, window
            window = window[advance:]
            first += advance
    while window:
        yield first, window
        window = window[advance:]
        first += advance
