"""Parameters of the decision whether an object moves in a frame."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class MovesNowParams(Frozen):
    """Motion of an object against the background in one frame, beyond the noise of the flow.

    Lengths are in px of the working grid.
    """

    floor: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.3, gt=0, description="residual motion that is never noise, lower bound, px/frame"
    )
    floor_medians: Annotated[float, Unit.RATIO] = Field(
        3.0, ge=0, description="the same, in medians of the background's residual"
    )
    floor_motion: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, description="the same, as a share of the background's motion at the pixel"
    )
    share: Annotated[float, Unit.SHARE] = Field(
        0.25,
        gt=0,
        le=1,
        description="share of an object's pixels beyond the noise from which it moves",
    )
