"""Parameters of outlines at full size."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class RefinementParams(Frozen):
    """Guided filter of the foreground by the frame's colours."""

    radius: Annotated[int, Unit.PIXELS] = Field(
        3, ge=1, description="half side of the filter's window, px of the working grid"
    )
    smoothness: Annotated[float, Unit.SHARE] = Field(
        1e-4, ge=1e-4, description="variance of colour, squared share of white, that counts as an edge"
    )
