"""Parameters of the search for black bars."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class BlackBarParams(Frozen):
    """Lines at the sides of a user's video that are dark in all frames, up to a straight edge of the picture.

    Bars are filled for the analysis, and nothing is found in them; the sequences of data sets are not searched.
    """

    fill: bool = Field(
        True,
        description="whether bars are left out: filled for the analysis with the border of the picture, and without "
        "objects; if not, bars are only named, and analysed as scene",
    )
    max_level: Annotated[int, Unit.GREY_LEVELS] = Field(
        24, ge=0, lt=255, description="brightest level of a pixel of a bar, in any of its colours"
    )
    max_bright: Annotated[float, Unit.SHARE] = Field(
        0.02,
        ge=0,
        lt=1,
        description="pixels of a row or column of a bar that may be brighter, in any one frame: beside the picture, "
        "coding leaves traces of it",
    )
    min_edge: Annotated[float, Unit.SHARE] = Field(
        0.5,
        gt=0,
        le=1,
        description="pixels of the picture beside a bar that are brighter than a bar in one frame at least: a bar ends "
        "in a straight edge, a dark part of the scene does not",
    )
    min_width: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, lt=1, description="smallest bar, relative to the frame's side"
    )
    min_picture: Annotated[float, Unit.SHARE] = Field(
        0.2, gt=0, le=1, description="smallest picture between bars, relative to the frame's side; else there are none"
    )
    num_frames: Annotated[int, Unit.FRAMES] = Field(
        16, ge=2, description="frames that are compared, spread over the video from its first to its last"
    )
