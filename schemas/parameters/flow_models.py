"""Parameters of the parametric flow models."""

from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen

FlowModelName = Literal["oc_depth", "oc_depth_paper", "oc"]


class FlowModelParams(Frozen):
    """Least-squares fit of a flow model to each object's pixels."""

    erosion: int = Field(0, ge=0, description="pixels next to another object are left out up to this distance, px")
    min_pixels: int = Field(
        64, ge=1, description="an object with fewer pixels has no model and no residual in that pair"
    )
    rank_tolerance: float = Field(
        1e-6, gt=0, lt=1, description="singular values below this share of the largest count as zero"
    )
