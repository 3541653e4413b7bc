"""Graphics drawn into a video's frames: what they mean for the result."""

from collections.abc import Iterable
from typing import NamedTuple

from moseg.schemas.screen_graphics import Polygon, ScreenGraphics

_MOST_NAMED = 4


class _Box(NamedTuple):
    left: int
    top: int
    right: int
    bottom: int


def describe_graphics(
    graphics: ScreenGraphics, analysed: tuple[int, int], shape: tuple[int, int], are_left_out: bool
) -> tuple[str, ...]:
    """Return what graphics mean for the result, in one line, or nothing where there are none.

    Parameters
    ----------
    graphics : ScreenGraphics
        In frames of the size `analysed` (height, width).
    analysed, shape : (int, int)
        `shape` is the video's own size, in whose pixels the line gives places.
    are_left_out : bool
        Whether they were filled for the analysis, else they were analysed as scene.
    """
    if not graphics.parts:
        return ()
    down, across = (size / small for size, small in zip(shape, analysed, strict=True))
    boxes = _joined_boxes(map(_box_of, graphics.parts))
    named = [_describe_box(box, across, down) for box in boxes[:_MOST_NAMED]]
    places = "; ".join(named if len(named) == len(boxes) else [*named, "and others"])
    if are_left_out:
        return (f"graphics in the frames ({places}) are left out: what is around them stands for them",)
    return (f"graphics in the frames ({places}) count as scene: they may be taken for objects",)


def _box_of(part: Polygon) -> _Box:
    columns, rows = zip(*part, strict=True)
    return _Box(max(min(columns), 0), max(min(rows), 0), max(columns) + 1, max(rows) + 1)


def _joined_boxes(boxes: Iterable[_Box]) -> list[_Box]:
    """Join the boxes that are as near each other as the letters of a word."""
    joined: list[_Box] = []
    for box in boxes:
        while near := [each for each in joined if _is_near(each, box)]:
            joined = [each for each in joined if each not in near]
            lefts, tops, rights, bottoms = zip(box, *near, strict=True)
            box = _Box(min(lefts), min(tops), max(rights), max(bottoms))
        joined.append(box)
    return joined


def _is_near(one: _Box, other: _Box) -> bool:
    """Return whether the gap between two boxes is at most half of the height of the lower one."""
    reach = min(one.bottom - one.top, other.bottom - other.top) / 2
    gaps = (max(one[side], other[side]) - min(one[side + 2], other[side + 2]) for side in (0, 1))
    return max(gaps) <= reach


def _describe_box(box: _Box, across: float, down: float) -> str:
    """Return size and place of a box in the video's own pixels."""
    width, height = round((box.right - box.left) * across), round((box.bottom - box.top) * down)
    return f"{width} x {height} px at {round(box.left * across)}, {round(box.top * down)}"
