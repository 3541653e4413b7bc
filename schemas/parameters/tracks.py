"""Parameters of object-specific point tracks."""

from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen


class TrackParams(Frozen):
    """Points sampled in every object and followed through a section."""

    method: Literal["lucas-kanade", "groundtruth"] = Field("lucas-kanade", description="point tracker")
    points_per_object: int = Field(40, ge=8, description="points kept in each object")
    resample_every: int = Field(8, ge=1, description="frames between checks of a point against its object's mask")
    border: int = Field(6, ge=0, description="points nearer than this to the frame's border are removed, px")
