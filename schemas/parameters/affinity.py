"""Parameters of the motion affinity between objects."""

from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen


class AffinityParams(Frozen):
    """How pairwise residuals become affinities."""

    method: Literal["residual", "ork"] = Field("residual", description="residual size, or the paper's weighted ORK")
    ork_threshold: int = Field(3, ge=1, description="t of the weighted ORK: how many smallest residuals score")
    ork_reading: Literal["models", "objects"] = Field(
        "models", description="rank the models for each object's data, or the objects under each model"
    )
    scale: float = Field(0.5, gt=0, description="residual size at which affinity falls to exp(-1/2), px")
