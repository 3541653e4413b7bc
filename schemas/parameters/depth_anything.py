"""Parameters of depth by Depth Anything V2."""

from pydantic import Field

from schemas.frozen import Frozen


class DepthAnythingParams(Frozen):
    """How large frames are shown to the network; its output is inverse depth already."""

    weights: str = Field("depth-anything-v2-small", description="weights item; `moseg backends` lists them")
    short_side: int = Field(
        518, ge=14, description="frames are resized to this shorter side for the network, px; 518 in its training"
    )
    max_side: int = Field(
        1540, ge=14, description="but never to a longer side above this, px; the cost of wide frames is bounded"
    )
