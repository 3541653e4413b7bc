"""Parameters of the masks of objects of tracks."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class TrackMaskParams(Frozen):
    """Votes of the nearest tracks for the object of a pixel, on a grid of every second pixel, and its outline."""

    radius: Annotated[float, Unit.PIXELS] = Field(
        30.0, gt=0, description="largest distance of an object's pixel from the object's nearest track, px"
    )
    closing: Annotated[float, Unit.PIXELS] = Field(
        50.0,
        ge=0,
        description="only pixels between an object's tracks count: every disc of this radius that contains them"
        " contains a track, too, px; 0: all within the radius",
    )
    margin: Annotated[float, Unit.PIXELS] = Field(
        6.0,
        ge=0,
        description="how far an object reaches around what lies between its tracks, px; where these are farther apart,"
        " as far as they are apart, at most twice this",
    )
    edge: Annotated[float, Unit.PIXELS] = Field(
        12.0, ge=0, description="distance of tracks from the frame's edge up to which they count on it too, px"
    )
    num_neighbours: Annotated[int, Unit.COUNT] = Field(10, ge=1, description="nearest tracks that vote for a pixel")
    distance: Annotated[float, Unit.PIXELS] = Field(
        10.0, gt=0, description="standard deviation of the votes' Gaussian weight by distance, px"
    )
    grey: Annotated[float, Unit.GREY_LEVELS] = Field(
        12.0, gt=0, description="the same by the difference of brightness, grey levels of 255"
    )
    grey_blur: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="standard deviation of the Gaussian blur of the frame before brightness is compared, px"
    )
    motion: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.8, gt=0, description="the same by the difference of the pixel's flow from the track's motion, px/frame"
    )
    relative_motion: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, description="addition to it, as a share of the pixel's flow"
    )
    smoothing: Annotated[int, Unit.PIXELS] = Field(
        2, ge=0, le=2, description="radius of the median filter of the labels, px of the grid; 0 is no filter"
    )
    softness: Annotated[float, Unit.PIXELS] = Field(
        8.0,
        ge=0,
        description="distance from an outline at which a pixel's object is 73 % sure, before edges of the frame draw"
        " the outline (refinement), px; 0: outlines of the grid",
    )
