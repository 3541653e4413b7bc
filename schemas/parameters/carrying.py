"""Parameters of masks that a user paints or adds in one frame, carried to other frames along the flow."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class CarryingParams(Frozen):
    """Reach of a mask that is carried from one frame, the evidence that carries it, and the limits where it is lost.

    Lengths in px refer to the grid, the frame reduced to `side`.
    """

    reach: Annotated[int, Unit.FRAMES] = Field(
        30,
        ge=0,
        description="frames before and after its own to which a mask is carried at most, if it is not lost before; "
        "the ends of its section in any case",
    )
    side: Annotated[int, Unit.PIXELS] = Field(
        427, ge=32, description="longer side of the grid on which it is carried, px; smaller frames are not enlarged"
    )
    consistency_relative: Annotated[float, Unit.SHARE] = Field(
        0.02, ge=0, description="forward-backward error allowed, share of |flow|^2"
    )
    consistency_absolute: Annotated[float, Unit.SQUARED_PIXELS_PER_FRAME] = Field(
        0.1, gt=0, description="forward-backward error allowed, (px/frame)^2"
    )
    colour: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=0, description="weight of the log ratio of the mask's colours to those around it, at its outline"
    )
    motion: Annotated[float, Unit.NATS] = Field(
        1.0, ge=0, description="largest evidence against a cell at the outline that moves like what is around the mask"
    )
    motion_noise: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.5, gt=0, description="noise of the flow in this evidence, px/frame"
    )
    growth: Annotated[float, Unit.SHARE] = Field(
        0.02, ge=0, description="share by which colours may enlarge a mask from frame to frame"
    )
    surroundings: Annotated[int, Unit.PIXELS] = Field(
        20, ge=1, description="width of the band around the mask whose colours and motion are compared with its own, px"
    )
    min_consistency: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, le=1, description="mean consistency of the flow in the mask below which it is lost"
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, le=1, description="area below which it is lost, share of that in its own frame"
    )
