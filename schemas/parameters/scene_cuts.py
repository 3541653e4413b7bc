"""Parameters of the search for cuts."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class SceneCutParams(Frozen):
    """Change of each frame against those around it, and the share of its pixels that flow finds in the frame before.

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
        description="pixels that flow there and back returns to, below which a frame begins a scene; 0 finds no cuts",
    )
    max_error: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="distance up to which a pixel has returned, px of the reduced frames"
    )
    window: Annotated[int, Unit.FRAMES] = Field(3, ge=1, description="frames before and after, whose changes are read")
    side: Annotated[int, Unit.PIXELS] = Field(160, ge=32, description="longer side to which frames are reduced, px")
    stretch_length: Annotated[int, Unit.FRAMES] = Field(
        64, ge=8, description="frames searched in one artifact; a rest shorter than half of it joins the one before"
    )
