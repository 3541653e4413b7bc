"""Parameters of the trajectory model: a fundamental matrix per object and frame pair."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class FundamentalParams(Frozen):
    """Eight-point algorithm inside RANSAC on each object's tracked points, and the residuals under it."""

    gap: Annotated[int, Unit.FRAMES] = Field(3, ge=1, description="frames between the two frames of a pair")
    step: Annotated[int, Unit.FRAMES] = Field(
        2, ge=1, description="frames between the first frames of the pairs that are fitted"
    )
    estimator: Literal["poselib", "eight_point_ransac"] = Field(
        "poselib",
        description="poselib (seven-point LO-RANSAC with non-linear refinement) or eight_point_ransac (the paper)",
    )
    threshold: Annotated[float, Unit.PIXELS] = Field(1.0, gt=0, description="Sampson distance of an inlier, px")
    num_samples: Annotated[int, Unit.COUNT] = Field(100, ge=1, description="minimal samples drawn for each fit")
    num_refits: Annotated[int, Unit.COUNT] = Field(
        5, ge=0, description="maximal number of local refits to the inliers (eight_point_ransac and homographies)"
    )
    min_points: Annotated[int, Unit.COUNT] = Field(
        8, ge=8, description="points visible in both frames below which an object is ignored"
    )
    statistic: Literal["median", "mean"] = Field(
        "median", description="statistic over an object's points: median, or mean (the paper)"
    )
    degenerate: Literal["discard", "keep", "homography"] = Field(
        "homography",
        description=(
            "a degenerate fit is invalid (discard, the paper), used (keep), or used unless the widest object shows no "
            "parallax, in which case homographies replace degenerate fits (homography)"
        ),
    )
    homography_ratio: Annotated[float, Unit.SHARE] = Field(
        0.95,
        gt=0,
        description="a homography explains the points if it has this share of the fundamental matrix's inliers",
    )
    collinear_width: Annotated[float, Unit.PIXELS] = Field(
        1.0, ge=0, description="root mean square distance to their best line below which points are collinear, px"
    )
    min_conditioning: Annotated[float, Unit.RATIO] = Field(
        1e-4, ge=0, description="minimal ratio of the eighth to the first singular value of the epipolar equations"
    )
