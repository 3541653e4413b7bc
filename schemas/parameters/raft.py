"""Parameters of RAFT's optical flow."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class RaftParams(Frozen):
    """Weights of RAFT and its computation per frame pair.

    References
    ----------
    Teed, Deng, "RAFT: Recurrent All-Pairs Field Transforms for Optical Flow", ECCV 2020.
    """

    weights: str = Field("raft-large", description="weights item; `moseg backends` lists them")
    iterations: Annotated[int, Unit.COUNT] = Field(
        20,
        ge=1,
        le=100,
        description="iterations; the authors take 20 for any video, 24 on KITTI and 32 on Sintel",
    )
    max_side: Annotated[int, Unit.PIXELS] = Field(
        1024,
        ge=128,
        description="longest side for the network, px; larger frames are reduced, their flow is enlarged again. "
        "The memory of stored correlations grows by its fourth power: 0.45 GB a pair at 1024x576, 5.6 GB at 1920x1080",
    )
    correlation: Literal["volume", "on_demand"] = Field(
        "volume", description="store all correlations, or compute them at each step: slower, with little memory"
    )
