"""Parameters of depth by Depth Anything 3."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class DepthAnything3Params(Frozen):
    """Weights of Depth Anything 3 and its input size; its output is depth, which is inverted."""

    weights: str = Field("depth-anything-3-base", description="weights item; `moseg backends` lists them")
    side: Annotated[int, Unit.PIXELS] = Field(
        504,
        ge=14,
        description="frames are resized to this longer side for the network, px; 504 in the authors' code, the base "
        "size of its training",
    )
