"""Parameters of depth by Depth Anything V2."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class DepthAnythingParams(Frozen):
    """Input size of the network, whose output is inverse depth."""

    weights: str = Field("depth-anything-v2-small", description="weights item; `moseg backends` lists them")
    short_side: Annotated[int, Unit.PIXELS] = Field(
        518, ge=14, description="frames are resized to this shorter side for the network, px; 518 in its training"
    )
    max_side: Annotated[int, Unit.PIXELS] = Field(
        1540, ge=14, description="upper bound of the longer side, px, which bounds the cost of wide frames"
    )
