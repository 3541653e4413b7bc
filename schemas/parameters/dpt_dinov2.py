"""Parameters of depth by DINOv2 with a DPT head."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class DptDinov2Params(Frozen):
    """Input size of the network, and the inversion of its metric depth."""

    weights: str = Field("dpt-dinov2-large-nyu", description="weights item; `moseg backends` lists them")
    max_side: Annotated[int, Unit.PIXELS] = Field(
        1022, ge=14, description="frames with a longer side are shrunk to this for the network, px; its cost is bounded"
    )
    nearest: Annotated[float, Unit.METRES] = Field(
        0.1,
        gt=0,
        description="lower bound of depth, m; that of the networks is 1 mm, the inverse of which would dominate a fit",
    )
