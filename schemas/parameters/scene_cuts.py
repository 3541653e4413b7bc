"""Parameters of the search for cuts."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class SceneCutParams(Frozen):
    """Change of each frame against those around it, and the pixels of the frame before that are found again in it.

    A user's video is segmented scene by scene; the sequences of data sets are not searched.
    """

    apart: bool = Field(
        True,
        description="whether each scene between two cuts is segmented like a video of its own; if not, cuts are only "
        "named, and the video is segmented as one scene",
    )

    min_change: Annotated[float, Unit.RATIO] = Field(
        1.25,
        ge=1,
        description="change from the frame before, above which a frame may begin a scene, relative to the "
        "largest change of those around it",
    )
    max_consistent: Annotated[float, Unit.SHARE] = Field(
        0.35,
        ge=0,
        le=1,
        description="pixels that are found again, below which a frame begins a scene; with 0, plain frames alone do",
    )
    max_error: Annotated[float, Unit.PIXELS] = Field(
        1.0,
        gt=0,
        description="distance from a pixel up to which flow there and back leads for it to be found again, px of the "
        "reduced frames",
    )
    min_contrast: Annotated[float, Unit.GREY_LEVELS] = Field(
        4.0, ge=0, description="local contrast of a pixel, in one frame or the other, below which it is not compared"
    )
    max_contrast_ratio: Annotated[float, Unit.RATIO] = Field(
        6.0,
        gt=1,
        description="ratio of the local contrasts of a pixel in both frames, above which it is not found again, "
        "as on a black frame or a plain title card",
    )
    max_plain: Annotated[float, Unit.GREY_LEVELS] = Field(
        2.0,
        ge=0,
        description="local contrast below which nearly all pixels of a plain frame are, as of those between a fade to "
        "black and the next scene; such frames are a scene of their own",
    )
    window: Annotated[int, Unit.FRAMES] = Field(3, ge=1, description="frames before and after, whose changes are read")
    side: Annotated[int, Unit.PIXELS] = Field(160, ge=32, description="longer side to which frames are reduced, px")
    stretch_length: Annotated[int, Unit.FRAMES] = Field(
        64, ge=8, description="frames searched in one artifact; a rest shorter than half of it joins the one before"
    )
