"""Parameters of the prompts that moving regions give to a segmentation network."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class MotionPromptParams(Frozen):
    """Points and boxes of moving regions, and the choice among the masks that a network makes of them."""

    use: Literal["both", "points", "box"] = Field(
        "both", description="prompts of a region: points and its box, points alone, or the box alone"
    )
    num_points: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, le=16, description="points in a region, far from its border and from each other"
    )
    trimmed: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, lt=0.5, description="share of a region's pixels beyond each side of its box, as strays"
    )
    margin: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, le=1, description="widening of the box at each side, share of its width or height"
    )
    min_area: Annotated[float, Unit.SHARE] = Field(
        0.0005, gt=0, le=1, description="minimal area of a region that prompts, share of the frame"
    )
    min_coverage: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="minimal share of the region that a mask of it covers"
    )
    max_growth: Annotated[float, Unit.RATIO] = Field(
        4.0, ge=1, description="maximal area of a mask, times that of its region; a larger one is of the scene"
    )
