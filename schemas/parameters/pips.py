"""Parameters of point tracking by PIPs."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class PipsParams(Frozen):
    """Inference of the PIPs network; `TrackParams` are the parameters of the sampling."""

    weights: str = Field("pips", description="weights item; `moseg backends` lists them")
    max_side: Annotated[int, Unit.PIXELS] = Field(
        640,
        ge=32,
        multiple_of=8,
        description="longer frames are shrunk to this for the network, px; 640 is the side of its published evaluation",
    )
    iterations: Annotated[int, Unit.COUNT] = Field(6, ge=1, description="steps of refinement of a window")
    min_visibility: Annotated[float, Unit.PROBABILITY] = Field(
        0.5, ge=0, le=1, description="visibility below which a track ends (our choice)"
    )
    points_per_pass: Annotated[int, Unit.COUNT] = Field(
        256, ge=1, description="points tracked at once: memory grows with it, about 0.5 MB a point"
    )
