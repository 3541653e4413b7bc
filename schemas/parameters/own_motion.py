"""Parameters of the motion of salient pixels."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class OwnMotionParams(Frozen):
    """The affine motion of salient pixels, and the residual of each pixel to it."""

    sharpness: Annotated[float, Unit.RATIO] = Field(
        5.0, gt=0, description="power of the foreground probability in a pixel's weight"
    )
    step: Annotated[int, Unit.PIXELS] = Field(4, ge=1, description="spacing of the grid for the fit of the motion, px")
    iterations: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="rounds of iteratively reweighted least squares"
    )
    tukey_constant: Annotated[float, Unit.RATIO] = Field(
        4.7, gt=0, description="residual, in scales, from which Tukey's weight is 0"
    )
    scale_floor: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.15, gt=0, description="smallest scale of the residuals in the fit, px/frame"
    )
    salient_share: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, lt=1, description="share of the largest weight below which weights are ignored in the fit"
    )
    slope_prior: Annotated[float, Unit.SQUARED_PIXELS] = Field(
        50.0, gt=0, description="weighted squared extent, px², at which a slope is halved by its prior"
    )
    spread_step: Annotated[int, Unit.PIXELS] = Field(
        3, ge=1, description="spacing of the pixels from which the spread is computed, px"
    )
    least_weight: Annotated[float, Unit.RATIO] = Field(
        10.0, gt=0, description="summed weight on the grid below which no motion is fitted"
    )
    spread: Annotated[float, Unit.SHARE] = Field(
        0.75, gt=0, le=1, description="quantile of the residuals of salient pixels that is the spread"
    )
    regions: Annotated[int, Unit.COUNT] = Field(
        4, ge=0, description="salient regions apart from each other, largest first, that may have motions of their own"
    )
    region_area: Annotated[float, Unit.SHARE] = Field(
        0.0005, ge=0, le=1, description="minimal area of such a region, share of the frame"
    )
    region_step: Annotated[int, Unit.PIXELS] = Field(
        2, ge=1, description="spacing of the grid for the fit of such a region's motion, px"
    )
    spread_floor: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(0.1, gt=0, description="minimal spread, px/frame")
