"""Parameters of dense point tracks."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class DenseTrackParams(Frozen):
    """Corners of the whole frame, tracked from two starts and replaced as they are lost."""

    contrast: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="clip limit of the contrast-limited equalisation before tracking"
    )
    contrast_tiles: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="tiles of that equalisation along each side of the frame"
    )
    max_points: Annotated[int, Unit.COUNT] = Field(
        # OpenCV samples a map at 32,766 points at most.
        5000,
        ge=8,
        le=32_766,
        description="maximal number of points in a frame",
    )
    corner_quality: Annotated[float, Unit.SHARE] = Field(
        0.002, gt=0, le=1, description="minimal corner response, as a share of the frame's largest one"
    )
    corner_block: Annotated[int, Unit.PIXELS] = Field(5, ge=3, le=255, description="side of the window of a corner, px")
    corner_distance: Annotated[int, Unit.PIXELS] = Field(
        6, ge=1, description="minimal distance of a new point from the others, px"
    )
    spacing: Annotated[float, Unit.PIXELS] = Field(
        3.6, gt=0, description="side of the cells in each of which the oldest track alone goes on, px"
    )
    border: Annotated[int, Unit.PIXELS] = Field(
        4, ge=1, description="points nearer than this to the frame's border are removed, px"
    )
    window: Annotated[int, Unit.PIXELS] = Field(11, ge=5, le=255, description="side of the Lucas-Kanade window, px")
    pyramid_levels: Annotated[int, Unit.COUNT] = Field(
        4, ge=0, description="pyramid levels above full resolution where tracking starts without a guess"
    )
    guided_levels: Annotated[int, Unit.COUNT] = Field(
        1, ge=0, description="the same where it starts from the dense flow"
    )
    forward_backward: Annotated[float, Unit.PIXELS] = Field(
        0.7, gt=0, description="maximal forward-backward error of a tracked point, px"
    )
    doubtful: Annotated[float, Unit.PIXELS] = Field(
        0.05,
        ge=0,
        description="forward-backward error of a point tracked from the dense flow from which it is tracked without it"
        " too, px",
    )
    min_frames: Annotated[int, Unit.FRAMES] = Field(3, ge=2, description="tracks shorter than this are dropped, frames")
