"""How the mask of each object changes over a sequence: its area, its parts, and the frames at which they change."""

from collections.abc import Sequence
from enum import StrEnum
from typing import NamedTuple

import numpy as np

WINDOW = 5
"""Frames before a frame whose median area is its reference; one fault of a frame does not move a median."""
MIN_SHARE = 0.5
"""Of the reference: a mask below it has shrunk. It has recovered above `RECOVERED_SHARE` of the same reference."""
RECOVERED_SHARE = 0.7
MIN_PART_SHARE = 0.1
"""Of the mask's area: smaller components are fringes of a mask, not parts of it."""


class ChangeKind(StrEnum):
    """What happens to a mask."""

    SHRINKS = "shrinks"
    SPLITS = "splits"
    VANISHES = "vanishes"


class MaskChange(NamedTuple):
    """A frame at which a mask changes.

    Attributes
    ----------
    frame : int
        First frame of the change, counted from 0.
    kind : ChangeKind
    amount : int
        The area that is left, percent of the median over the frames before; the number of parts; or the number of
        frames without the object, 0 where it does not return.
    is_at_edge : bool
        Whether the mask touches the border of the picture, in this frame or in the last one that shows it: then the
        object may be leaving the picture.
    """

    frame: int
    kind: ChangeKind
    amount: int
    is_at_edge: bool


class MaskHistory:
    """Area and parts of each object in each frame, gathered one frame at a time.

    Attributes
    ----------
    num_frames : int
    """

    def __init__(self):
        self.num_frames = 0
        self._seen: dict[int, list[tuple[int, int, int, bool]]] = {}

    def add(self, labels: np.ndarray) -> None:
        """Add the next frame's labels, uint16 (y, x); 0 = static."""
        for identity in (np.flatnonzero(np.bincount(labels.ravel())[1:]) + 1).tolist():
            entry = (self.num_frames, *_measure(labels == identity))
            self._seen.setdefault(identity, []).append(entry)
        self.num_frames += 1

    def identities(self) -> tuple[int, ...]:
        """Return the identities seen in any frame, from the largest total area to the smallest."""
        total = {identity: sum(area for _, area, _, _ in seen) for identity, seen in self._seen.items()}
        return tuple(sorted(total, key=lambda identity: (-total[identity], identity)))

    def areas(self, identity: int) -> np.ndarray:
        """Return an object's area in each frame, int64 (frame,), px; 0 where it is not seen."""
        return self._column(identity, 1)

    def changes(self, identity: int) -> tuple[MaskChange, ...]:
        """Return the frames at which an object's mask shrinks, splits or vanishes, in order."""
        return find_changes(self.areas(identity), self._column(identity, 2), self._column(identity, 3) > 0)

    def _column(self, identity: int, place: int) -> np.ndarray:
        values = np.zeros(self.num_frames, np.int64)
        for entry in self._seen.get(identity, ()):
            values[entry[0]] = entry[place]
        return values


def find_changes(areas: Sequence[int], num_parts: Sequence[int], is_at_edge: Sequence[bool]) -> tuple[MaskChange, ...]:
    """Find the frames at which a mask shrinks, splits or vanishes.

    Parameters
    ----------
    areas : sequence of int
        Of each frame, px; 0 where the object is not seen.
    num_parts : sequence of int
        Large connected components of the mask in each frame.
    is_at_edge : sequence of bool
        Whether the mask touches the border of the picture.
    """
    changes: list[MaskChange] = []
    recent: list[int] = []
    recovery = 0.0
    last_split = -WINDOW
    for frame, area in enumerate(areas):
        before = frame - 1
        was_seen = frame > 0 and areas[before] > 0
        if not area:
            if was_seen:
                gone = next((number for number, later in enumerate(areas[frame:]) if later), 0)
                changes.append(MaskChange(frame, ChangeKind.VANISHES, gone, bool(is_at_edge[before])))
            recent, recovery = [], 0.0
            continue
        reference = float(np.median(recent)) if len(recent) > 1 else 0.0
        if recovery:
            recovery = 0.0 if area >= recovery else recovery
        elif area < MIN_SHARE * reference:
            share = round(100 * area / reference)
            changes.append(MaskChange(frame, ChangeKind.SHRINKS, share, bool(is_at_edge[frame])))
            recovery = RECOVERED_SHARE * reference
        if was_seen and num_parts[frame] > 1 and num_parts[before] == 1 and frame - last_split >= WINDOW:
            changes.append(MaskChange(frame, ChangeKind.SPLITS, int(num_parts[frame]), bool(is_at_edge[frame])))
            last_split = frame
        recent = [*recent, int(area)][-WINDOW:]
    return tuple(changes)


def _measure(mask: np.ndarray) -> tuple[int, int, bool]:
    """Return area, number of large components, and whether it touches the border, of a mask bool (y, x)."""
    # Only here: commands that compute nothing start without it.
    import cv2

    pixels = mask.view(np.uint8)
    x, y, width, height = cv2.boundingRect(pixels)
    is_at_edge = x == 0 or y == 0 or x + width == mask.shape[1] or y + height == mask.shape[0]
    crop = np.ascontiguousarray(pixels[y : y + height, x : x + width])
    _, _, stats, _ = cv2.connectedComponentsWithStats(crop, connectivity=8)
    sizes = stats[1:, cv2.CC_STAT_AREA]
    area = int(sizes.sum())
    return area, int(np.count_nonzero(sizes >= MIN_PART_SHARE * area)), is_at_edge
