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
    relative: float = Field(1.0, ge=0, description="share of the data object's own residual added to the scale")
    excess: bool = Field(True, description="take what an object's own model leaves off its residuals under other models")
    direction: Literal["min", "mean", "max"] = Field(
        "min", description="which of the two residuals of a pair of objects counts"
    )
    quantile: float = Field(0.5, ge=0, le=1, description="quantile over frame pairs of the distance between two objects")
