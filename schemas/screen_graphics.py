"""Graphics that were drawn into the frames of a video: logos, clocks, captions."""

from collections.abc import Sequence
from typing import NamedTuple

Polygon = Sequence[Sequence[int]]
"""Corners xy of a convex polygon, px."""


class ScreenGraphics(NamedTuple):
    """Places at which a video shows graphics instead of the scene, in all of its frames.

    Attributes
    ----------
    parts : sequence of Polygon
        Convex polygons, px of the analysed frames, which may overlap.
    """

    parts: Sequence[Polygon] = ()

    def as_json(self) -> dict[str, list[list[list[int]]]]:
        """Return the attributes as JSON has them."""
        return {"parts": [[[*corner] for corner in part] for part in self.parts]}

    def moved(self, right: int, down: int) -> "ScreenGraphics":
        """Return the same graphics `right` and `down` px from here."""
        return ScreenGraphics(tuple(tuple((x + right, y + down) for x, y in part) for part in self.parts))
