"""Parameters of the distance of the pictures between which motion is seen where it is slow."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class SlowMotionParams(Frozen):
    """Motion of a stretch of video, which decides how far apart the pictures of a pair are.

    Lengths are px of the working grid (`saliency.working_side`), those of the fastest thousandth of the pixels.
    """

    max_gap: Annotated[int, Unit.FRAMES] = Field(
        8, ge=1, le=16, description="largest distance of the pictures of a pair; 1 looks for no slow motion"
    )
    residual: Annotated[float, Unit.PIXELS] = Field(
        7.0,
        gt=0,
        description="motion beside that of the background, to which the distance brings that of most pairs, px",
    )
    share_of_pairs: Annotated[float, Unit.SHARE] = Field(
        0.875, gt=0, le=1, description="share of the pairs that move by `residual` at most, at the distance"
    )
    motion: Annotated[float, Unit.PIXELS] = Field(
        24.0, gt=0, description="motion that no pair exceeds at the distance, the camera's included, px"
    )
    percentile: Annotated[float, Unit.PERCENT] = Field(
        99.9, gt=50, le=100, description="percentile of the pixels' motion that is read"
    )
    num_pairs: Annotated[int, Unit.COUNT] = Field(8, ge=1, description="pairs of neighbouring frames read a stretch")
    min_pairs: Annotated[int, Unit.COUNT] = Field(4, ge=1, description="least number of these in a short video")
    stretch_length: Annotated[int, Unit.FRAMES] = Field(
        64, ge=32, description="frames with one distance; a rest shorter than half of it joins the one before"
    )
