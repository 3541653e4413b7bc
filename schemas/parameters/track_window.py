"""Parameters of the frames that objects of tracks are found in."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class TrackWindowParams(Frozen):
    """Window of a section: its frames and those around them through which dense tracks are followed."""

    overlap: Annotated[int, Unit.FRAMES] = Field(
        4, ge=1, description="frames of the next section in which a section's objects are labelled, for linking"
    )
    min_frames: Annotated[int, Unit.FRAMES] = Field(
        20, ge=2, description="smallest window: that of a short section begins before it"
    )
