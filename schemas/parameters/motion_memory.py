"""Parameters of the memory of motion, which keeps what has moved while it rests."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class MotionMemoryParams(Frozen):
    """Mean of the odds of motion along the flow, over many more frames than the accumulated saliency."""

    memory: Annotated[float, Unit.RATIO] = Field(
        0.97, ge=0, lt=1, description="weight of the other frames where the flow is consistent"
    )
    max_odds: Annotated[float, Unit.RATIO] = Field(
        20.0, gt=0, le=10000, description="largest odds of motion of a frame: how long one object can be remembered"
    )
