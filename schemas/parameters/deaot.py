"""Parameters of mask tracking by DeAOT."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class DeaotParams(Frozen):
    """Input size and memory of DeAOT.

    References
    ----------
    Yang and Yang, "Decoupling Features in Hierarchical Propagation for Video Object Segmentation", NeurIPS 2022.
    """

    weights: str = Field("deaot-r50-l", description="weights item; `moseg backends` lists them")
    max_side: Annotated[int, Unit.PIXELS] = Field(
        1040,
        ge=17,
        description="frames with a longer side are shrunk to this for the network, px; the authors' evaluation takes "
        "1.3 x 800, which leaves 854x480 as it is. Time and memory grow by its fourth power",
    )
    memory_every: Annotated[int, Unit.FRAMES] = Field(
        5, ge=1, description="frames between those kept in the long-term memory"
    )
    memory_frames: Annotated[int, Unit.FRAMES] = Field(
        8,
        ge=1,
        description="frames of the long-term memory: the first and the newest others. The authors keep all; time "
        "and memory grow with it (23 MB a frame for each ten objects at 854x480, in float32)",
    )
