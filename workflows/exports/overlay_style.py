"""Style of an overlay: how it shows the moving objects."""

from enum import StrEnum

from pydantic import Field

from moseg.schemas.frozen import Frozen

DEFAULT_OPACITY = 0.45
"""Visible on foliage, with the texture still visible."""
DEFAULT_OUTLINE_WIDTH = 2
MOST_OUTLINE_WIDTH = 64


class OverlayMode(StrEnum):
    """Drawing of the objects in a frame."""

    OUTLINE = "outline"
    """Each object tinted in its colour, with a line along its border."""
    FILL = "fill"
    """The tint alone."""
    CONTOUR = "contour"
    """The line alone."""
    MASK = "mask"
    """Colours on black, without the frame."""
    CUTOUT = "cutout"
    """Objects as they are, the rest in dim grey."""


TINTED = (OverlayMode.OUTLINE, OverlayMode.FILL)
"""Modes that have an opacity."""
LINED = (OverlayMode.OUTLINE, OverlayMode.CONTOUR)
"""Modes that have an outline."""


class OverlayStyle(Frozen):
    """How an overlay shows the moving objects.

    Attributes
    ----------
    mode : OverlayMode
    opacity : float
        Share of an object's colour in its pixels, 0..1, in the modes of `TINTED`.
    outline_width : int
        Width of the line along an object's border, px, half of it to either side, in the modes of `LINED`; 0 is none.
    is_side_by_side : bool
        Whether the untouched frame stands at the left.
    has_identities : bool
        Whether each object bears its number, and its name if it has one.
    """

    mode: OverlayMode = OverlayMode.OUTLINE
    opacity: float = Field(default=DEFAULT_OPACITY, ge=0, le=1)
    outline_width: int = Field(default=DEFAULT_OUTLINE_WIDTH, ge=0, le=MOST_OUTLINE_WIDTH)
    is_side_by_side: bool = False
    has_identities: bool = False


DEFAULT_STYLE = OverlayStyle()
