"""Parameters of the accumulation of maps along the flow."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class AccumulationParams(Frozen):
    """Averages of a frame's maps with those of the frames before and after it, warped by the flow."""

    memory: Annotated[float, Unit.RATIO] = Field(
        0.85, ge=0, lt=1, description="weight of the other frames where the flow is consistent"
    )
    consistency_floor: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=0, le=1, description="lower bound of the consistency that scales the memory"
    )
    reliability_floor: Annotated[float, Unit.RATIO] = Field(
        0.1, gt=0, le=1, description="weight of a frame's saliency where its flow is inconsistent"
    )
    consistency_relative: Annotated[float, Unit.SHARE] = Field(
        0.02, ge=0, description="forward-backward error allowed, share of |flow|^2"
    )
    consistency_absolute: Annotated[float, Unit.SQUARED_PIXELS_PER_FRAME] = Field(
        0.1, gt=0, description="forward-backward error allowed, (px/frame)^2"
    )
