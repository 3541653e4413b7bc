"""Parameters of the motion affinity between objects."""

from typing import Literal

from pydantic import Field

from schemas.frozen import Frozen


class AffinityParams(Frozen):
    """How pairwise residuals become affinities."""

    method: Literal["residual", "ork"] = Field("residual", description="residual size, or the paper's weighted ORK")
    ork_threshold: int = Field(2, ge=1, description="t of the weighted ORK: how many smallest residuals score")
    ork_reading: Literal["models", "objects"] = Field(
        "models", description="rank the models for each object's data, or the objects under each model"
    )
    scale: float = Field(0.5, gt=0, description="residual size at which affinity falls to exp(-1/2), px")
    relative: float = Field(
        1.0, ge=0, description="share of both objects' residuals under their own models added to the scale, in squares"
    )
    relative_flow: float = Field(
        0.05, ge=0, description="share of the object's flow length added to the scale, in squares; flow models only"
    )
    excess: bool = Field(
        True, description="take what an object's own model leaves off its residuals under other models"
    )
    direction: Literal["background", "min", "mean", "max"] = Field(
        "background",
        description=(
            "which of the two residuals of a pair of objects counts: the smaller, their mean, the larger, or "
            "(background) that under the background's model where one of the two is the background, else the smaller"
        ),
    )
    quantile: float = Field(
        0.5, ge=0, le=1, description="quantile over frame pairs of the distance between two objects"
    )
