"""Parameters of the parametric flow models."""

from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen

FlowModelName = Literal["oc_depth", "oc_depth_paper", "oc"]


class FlowModelParams(Frozen):
    """Least-squares fit of a flow model to each object's pixels."""

    erosion: int = Field(0, ge=0, description="pixels stripped from each object's outline before fitting, px")
