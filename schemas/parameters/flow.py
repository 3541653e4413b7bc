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
        description="DIS preset; fine is medium at full resolution, light is medium with fewer patches and iterations,"
        " lighter without variational refinement too, balanced with still fewer patches than light, but more iterations"
        " of their descent (dis only)",
    )
    search_side: Annotated[int, Unit.PIXELS] = Field(
        640,
        ge=16,
        description="longer side of the grid at which the search ends, px, where the preset's is shorter by more than a"
        " tenth; that of the frames where they are smaller (dis only)",
    )
    enlarged_side: Annotated[int, Unit.PIXELS] = Field(
        427,
        ge=16,
        description="longer side to which frames that are smaller than that are enlarged for the search, to twice their"
        " size and search_side at most, px (dis only)",
    )
    coarse_side: Annotated[int, Unit.PIXELS] = Field(
        107,
        ge=0,
        description="longer side of a coarse grid that is searched first, with a patch at each pixel, px; its flow is a"
        " candidate of each patch. 0: none; none either where the search ends on a grid of less than three times this"
        " side (dis only)",
    )
