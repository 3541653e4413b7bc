"""Parameters of the moving objects that a result holds."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class MovingObjectParams(Frozen):
    """Moving objects that the result leaves out."""

    min_area: Annotated[float, Unit.SHARE] = Field(
        0.0,
        ge=0,
        lt=1,
        description="share of the frame that an object covers in at least one frame, or else the result leaves it out;"
        " its motion still counts",
    )
