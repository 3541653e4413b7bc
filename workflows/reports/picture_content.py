"""What a report shows as pictures: layers over frames, their legends, a video."""

from enum import StrEnum
from typing import NamedTuple


class Picture(NamedTuple):
    """An encoded picture, as a page embeds it.

    Attributes
    ----------
    media_type : str
        ``image/webp``, ``image/png`` or ``image/jpeg``.
    data : bytes
    width, height : int
        Px.
    """

    media_type: str
    data: bytes
    width: int
    height: int


class Video(NamedTuple):
    """An encoded video of a sequence; H.264 in MP4.

    Attributes
    ----------
    data : bytes
    width, height : int
        Px.
    fps : float
        Frames of the video per second.
    step : int
        It holds every `step`-th frame of the sequence, from the first one on.
    """

    data: bytes
    width: int
    height: int
    fps: float
    step: int = 1


class LayerKind(StrEnum):
    """How a layer is shown."""

    BASE = "base"
    """An opaque picture, one at a time: the frame, flow, saliency, inverse depth."""
    OVER = "over"
    """Transparent where it says nothing, so that several lie over the base: masks, ground truth, errors, tracks."""


class LegendEntry(NamedTuple):
    """A colour and what it means; colours are ``#rrggbb``."""

    colour: str
    meaning: str


class Layer(NamedTuple):
    """One picture for each frame that a sequence shows.

    Attributes
    ----------
    name : str
        Unique in its sequence, for instance ``moving objects (fused)``.
    kind : LayerKind
    pictures : tuple of Picture or None
        One for each of the sequence's `frames`; None where the frame has none (no annotation, last frame's flow).
    legend : tuple of LegendEntry
    key : Picture or None
        A colour key that no list can give: the wheel of flow directions, a colour bar.
    description : str
        One sentence: what is drawn, with its unit.
    is_shown : bool
        Whether the page shows it at first.
    is_beside : bool
        Whether it is for the picture beside: the first such layer is shown there at first.
    """

    name: str
    kind: LayerKind
    pictures: tuple[Picture | None, ...]
    legend: tuple[LegendEntry, ...] = ()
    key: Picture | None = None
    description: str = ""
    is_shown: bool = False
    is_beside: bool = False
