"""One object, followed through the masks of a sequence."""

import math
from dataclasses import dataclass, field

_DECIMALS = 4


@dataclass
class FollowedObject:
    """One identity, and columns of what was found in each frame that shows it.

    Attributes
    ----------
    identity : int
    frames : list of int
        Counted from 0.
    areas : list of int
        px.
    at_border : list of bool
        Whether it touches the frame's border: a part of it may be outside.
    growth : list of float
        Logarithm of its area over that in the frame before, by its flow; 0 where that is not known.
    sure, complete : list of float or None
        Expected precision and recall of its mask; None where it has none, and shorter where that is not known.
    moving : list of int
        Frames in which it moves now.
    """

    identity: int
    frames: list[int] = field(default_factory=list)
    areas: list[int] = field(default_factory=list)
    at_border: list[bool] = field(default_factory=list)
    growth: list[float] = field(default_factory=list)
    sure: list[float | None] = field(default_factory=list)
    complete: list[float | None] = field(default_factory=list)
    moving: list[int] = field(default_factory=list)

    def see(self, frame: int, area: int, at_border: bool, growth: float) -> None:
        """Add a frame that shows the object."""
        self.frames.append(frame)
        self.areas.append(area)
        self.at_border.append(at_border)
        self.growth.append(growth)

    def judge(self, sure: float, complete: float) -> None:
        """Add expected precision and recall of the last frame's mask, NaN where it has none."""
        for values, value in ((self.sure, sure), (self.complete, complete)):
            values.append(None if math.isnan(value) else round(value, _DECIMALS))


def mean_known(values: list[float | None]) -> float | None:
    """Return the mean of what is known, rounded; None without anything."""
    known = [value for value in values if value is not None]
    return round(sum(known) / len(known), _DECIMALS) if known else None
