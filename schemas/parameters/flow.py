"""Parameters of dense optical flow."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class FlowParams(Frozen):
    """Source of the flow of each frame pair."""

    method: Annotated[str, ChoiceOf("flow.method")] = Field(
        "dis", description="backend: dis (OpenCV DIS), raft, sea-raft, exact maps of the data set, or a folder"
    )
    preset: Literal["ultrafast", "fast", "lighter", "light", "balanced", "medium", "fine"] = Field(
        "balanced",
        description="DIS preset; fine is medium at full resolution, balanced is medium with fewer iterations, light"
        " also with fewer patches, lighter without variational refinement too (dis only)",
    )
    search_side: Annotated[int, Unit.PIXELS] = Field(
        427,
        ge=16,
        description="longer side of the grid at which the search ends, px, where the preset's is shorter; small frames"
        " are enlarged for it, to twice their size at most (dis only)",
    )
