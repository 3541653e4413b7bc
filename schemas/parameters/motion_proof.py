"""Parameters of the photometric proof of motion."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class MotionProofParams(Frozen):
    """Comparison of a pixel's colour error under the background's motion with that under its own flow."""

    error_floor: Annotated[float, Unit.GREY_LEVELS] = Field(
        4.0, gt=0, description="added to both errors before their ratio is taken, so that noise proves nothing"
    )
    blur: Annotated[float, Unit.PIXELS] = Field(
        1.5, gt=0, description="sigma of the Gaussian over both errors, px of the working grid"
    )
    memory: Annotated[float, Unit.RATIO] = Field(
        0.8, ge=0, lt=1, description="weight of the frame before in the average along the flow"
    )
