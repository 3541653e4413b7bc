"""Parameters of the trajectory model: a fundamental matrix per object and frame pair."""

from pydantic import Field

from schemas.frozen import Frozen


class FundamentalParams(Frozen):
    """Eight-point algorithm inside RANSAC on each object's tracked points."""

    gap: int = Field(3, ge=1, description="frames between the two frames of a pair")
    threshold: float = Field(1.0, gt=0, description="Sampson distance of an inlier, px")
