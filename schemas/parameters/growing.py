"""Parameters of an object that is grown from points of a frame, without networks."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class GrowingParams(Frozen):
    """Evidence that a cell belongs to the object at a point, and the region. Lengths in px of the working grid."""

    spot: Annotated[float, Unit.PIXELS] = Field(
        3.0, ge=0, description="radius of the disc around a point whose motion and colours are the object's, px"
    )
    motion_relative: Annotated[float, Unit.SHARE] = Field(
        1.0, ge=0, description="difference of motion that is still alike (sigma), share of the point's own"
    )
    motion_absolute: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.5, gt=0, description="the same, px/frame; both add up"
    )
    colour: Annotated[float, Unit.GREY_LEVELS] = Field(
        20.0, gt=0, description="difference in lightness (0..100) that is still alike (sigma); half of it in a and b"
    )
    min_level: Annotated[float, Unit.SHARE] = Field(
        0.05, gt=0, lt=0.9, description="lowest evidence at which a region is looked for"
    )
    min_step: Annotated[float, Unit.SHARE] = Field(
        0.15, ge=0, le=1, description="step of the evidence across a region's outline below which colours decide alone"
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        1e-4, ge=0, le=1, description="smallest area of a region, share of the frame"
    )
    max_area: Annotated[float, Unit.SHARE] = Field(0.5, gt=0, le=1, description="largest area, share of the frame")
    max_still_area: Annotated[float, Unit.SHARE] = Field(
        0.1, gt=0, le=1, description="largest area of a region by colour alone, share of the frame: others are scenery"
    )
    band: Annotated[int, Unit.PIXELS] = Field(
        3, ge=1, description="width of the bands on both sides of an outline that are compared, px"
    )
    surroundings: Annotated[int, Unit.PIXELS] = Field(
        20, ge=1, description="width of the band around the region whose colours are compared with its own, px"
    )
    colour_weight: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=0, description="weight of the log ratio of the region's colours to those around it"
    )
    rounds: Annotated[int, Unit.COUNT] = Field(4, ge=0, description="rounds in which colours correct the outline")
