"""Parameters of the search for frames that repeat the one before them after they were coded again."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class RepetitionParams(Frozen):
    """Change from each frame to the next, compared with the largest changes before and after it.

    Frames that are decoded to the same pixels are repetitions without it.
    """

    max_change: Annotated[float, Unit.SHARE] = Field(
        0.18,
        ge=0,
        lt=1,
        description="change below which a frame repeats the one before it, as a share of the largest change before it "
        "and of that after it; 0 compares nothing",
    )
    min_change: Annotated[float, Unit.GREY_LEVELS] = Field(
        1.25, ge=0, description="largest change on either side below which nothing repeats, grey levels"
    )
    window: Annotated[int, Unit.FRAMES] = Field(5, ge=1, description="frames before and after, whose changes are read")
    step: Annotated[int, Unit.PIXELS] = Field(2, ge=1, description="distance of the rows that are compared, px")
    stretch_length: Annotated[int, Unit.FRAMES] = Field(
        64, ge=8, description="frames compared in one artifact; a rest shorter than half of it joins the one before"
    )
