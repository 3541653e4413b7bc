"""Parameters of the parametric flow models."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class FlowModelParams(Frozen):
    """Least-squares fit of a flow model to each object's pixels."""

    # DIS computes flow at half the resolution at most (unless its preset is fine) and interpolates: the pixels
    # between carry no information.
    step: Annotated[int, Unit.PIXELS] = Field(
        2, ge=1, description="spacing of the rows and columns of the flow that are read"
    )
    erosion: Annotated[int, Unit.PIXELS] = Field(
        0, ge=0, description="distance to another object up to which pixels are ignored, in pixels that are read"
    )
    min_pixels: Annotated[int, Unit.COUNT] = Field(
        16, ge=1, description="an object with fewer pixels that are read has no model and no residual in that pair"
    )
    rank_tolerance: Annotated[float, Unit.SHARE] = Field(
        1e-6, gt=0, lt=1, description="singular values below this share of the largest count as zero"
    )
