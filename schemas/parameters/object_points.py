"""Parameters of the points of moving objects, followed by the motion of the whole object."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ObjectPointParams(Frozen):
    """Points of moving objects, followed by the motion of the whole object where the tracker of points lost them."""

    max_motions: Annotated[int, Unit.COUNT] = Field(
        3, ge=0, description="motions of an object from one frame to the next, each a similarity; 0: none is followed"
    )
    min_points: Annotated[int, Unit.COUNT] = Field(5, ge=3, description="fewest points that show a motion")
    min_share: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, le=1, description="fewest of them, as a share of the object's points"
    )
    tolerance: Annotated[float, Unit.PIXELS] = Field(
        4.0, gt=0, description="largest distance of a point from where a motion brings it, px"
    )
    max_growth: Annotated[float, Unit.RATIO] = Field(
        1.6,
        ge=1,
        lt=2,
        description="largest growth from one frame to the next from which the next motion is expected",
    )
    window: Annotated[int, Unit.PIXELS] = Field(
        15, ge=5, le=255, description="side of the Lucas-Kanade window in the frame that the motion brought along, px"
    )
    pyramid_levels: Annotated[int, Unit.COUNT] = Field(
        2, ge=0, le=8, description="pyramid levels of this search, besides the frame"
    )
    forward_backward: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="largest distance of a point from its start after tracking there and back, px"
    )
    slip: Annotated[float, Unit.PIXELS] = Field(
        10.0, ge=0, description="largest distance of what Lucas-Kanade finds from where the motion brings a point, px"
    )
    patch: Annotated[int, Unit.PIXELS] = Field(
        15, ge=3, le=255, description="side of the patches of both frames that are correlated, px"
    )
    min_correlation: Annotated[float, Unit.RATIO] = Field(
        0.6, ge=-1, le=1, description="least correlation of the patches of a point that is followed"
    )
    min_corner_correlation: Annotated[float, Unit.RATIO] = Field(
        0.8, ge=-1, le=1, description="the same of a new corner"
    )
    gain: Annotated[float, Unit.RATIO] = Field(
        0.1,
        ge=0,
        description="least difference of a new corner's correlation under the motion of its side from that under the"
        " other side's",
    )
    min_roundness: Annotated[float, Unit.RATIO] = Field(
        0.02,
        ge=0,
        le=1,
        description="least ratio of the eigenvalues of a patch's structure tensor: points of straight edges agree with"
        " many motions",
    )
    min_contrast: Annotated[float, Unit.SHARE] = Field(
        0.3,
        ge=0,
        description="least contrast of a point's patch, as a share of the median of the object's tracks: a plain"
        " surface beside an object seems to follow it",
    )
    reach: Annotated[float, Unit.PIXELS] = Field(
        25.0, ge=0, description="largest distance of a new corner from a point of the object, px"
    )
    spacing: Annotated[int, Unit.PIXELS] = Field(6, ge=1, description="least distance of new corners from points, px")
    corner_quality: Annotated[float, Unit.SHARE] = Field(
        0.003, gt=0, le=1, description="least strength of a new corner, as a share of that of the strongest around"
    )
    min_frames: Annotated[int, Unit.FRAMES] = Field(
        3, ge=2, description="new corners that were followed through fewer frames do not count, frames"
    )
