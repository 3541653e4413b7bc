"""Parameters of SEA-RAFT's optical flow."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.parameters.raft import RaftParams
from moseg.schemas.units import Unit


class SeaRaftParams(RaftParams):
    """Weights of SEA-RAFT and its computation per frame pair.

    References
    ----------
    Wang, Lipson, Deng, "SEA-RAFT: Simple, Efficient, Accurate RAFT for Optical Flow", ECCV 2024.
    """

    weights: str = Field("sea-raft-m", description="weights item; `moseg backends` lists them")
    iterations: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, le=100, description="iterations; the authors take 4 for their networks S and M, and 12 for L"
    )
    max_side: Annotated[int, Unit.PIXELS] = Field(
        960,
        ge=128,
        description="longest side for the network, px; larger frames are reduced, their flow is enlarged again. "
        "The authors reduce 1920x1080 to 960x540, the size that the weights were trained at",
    )
