"""Parameters of the static surfaces that are proposed beside the moving objects of dense tracks."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class TrackSurfaceParams(Frozen):
    """Surfaces of tracks that stand above the ground, each at one depth: parked cars, poles, trunks, walls."""

    max_candidates: Annotated[int, Unit.COUNT] = Field(
        16,
        ge=0,
        description="largest number of static candidates of the first section: objects with too little evidence to"
        " move, then surfaces",
    )
    halved_after: Annotated[int, Unit.SECTIONS] = Field(
        2,
        ge=1,
        description="sections after which that number is halved, again and again: what affinities cost grows with the"
        " square of all objects of a video",
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(6, ge=1, description="smallest number of tracks of a surface")
    num_neighbours: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, description="nearest tracks in a frame that are compared with a track"
    )
    radius: Annotated[float, Unit.PIXELS] = Field(
        20.0, gt=0, description="largest distance of two tracks that are compared, px"
    )
    agreement: Annotated[float, Unit.SHARE] = Field(
        0.04, ge=0, description="largest mean difference of the inverse depth of neighbouring tracks of a surface"
    )
    noise: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=0, description="addition to it, in standard deviations of inverse depth; both add as squares"
    )
    mask_radius: Annotated[float, Unit.PIXELS] = Field(
        12.0, gt=0, description="largest distance of a surface's pixel from the surface's nearest track, px"
    )
