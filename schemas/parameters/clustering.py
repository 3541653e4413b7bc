"""Parameters of the fusion of views, of the grouping of objects and of the number of motions."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.affinity import HypothesisAffinityParams
from moseg.schemas.units import Unit

TRACK_METHODS = ("description_length", "geometric")
"""Methods for the number of motions that compare the residuals of the tracks."""
READ_TRACKS = (*TRACK_METHODS, "stability")
"""Methods that read tracks; the others only read affinities."""

_FITS = frozenset(
    {"most_motions", "gap", "num_samples", "num_refits", "threshold", "truncation", "homography_ratio", "least_span"}
)
COUNT_READS = {
    "description_length": _FITS | {"outlier_range", "least_noise", "parameter_price"},
    "geometric": _FITS | {"motion_price"},
    "confidences": frozenset({"most_motions", "least_silhouette"}),
    "stability": frozenset({"most_motions", "gap", "affinity", "num_resamples", "least_agreement"}),
}
"""Parameters of `MotionCountParams` that each method for the number of motions reads; other methods read none."""


class MotionCountParams(Frozen):
    """Comparison of clusterings into 1, 2, ... motions if the number is not given."""

    most_motions: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, le=19, description="largest number of motions that is tried"
    )
    gap: Annotated[int, Unit.FRAMES] = Field(3, ge=1, description="frames between the two frames of a pair")
    num_samples: Annotated[int, Unit.COUNT] = Field(100, ge=1, description="minimal samples drawn for each fit")
    threshold: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="Sampson distance of an inlier of a fundamental matrix, px"
    )
    num_refits: Annotated[int, Unit.COUNT] = Field(
        5, ge=0, description="most local refits of a homography to its inliers"
    )
    homography_ratio: Annotated[float, Unit.SHARE] = Field(
        0.95,
        ge=0,
        description="a pair shows no parallax if the homography of its widest object has this share of the fundamental"
        " matrix's inliers",
    )
    least_span: Annotated[float, Unit.RATIO] = Field(
        0.5,
        ge=0,
        description="spread of the widest object, as a ratio to that of all tracks, below which parallax is assumed",
    )
    truncation: Annotated[float, Unit.PIXELS] = Field(
        0.5,
        gt=0,
        description="scale of the loss of affine fits, and distance at which the cost of an observation is 1, px",
    )
    motion_price: Annotated[float, Unit.SHARE] = Field(
        0.02, ge=0, description="penalty on a motion, in shares of observations (geometric)"
    )
    outlier_range: Annotated[float, Unit.PIXELS] = Field(
        5.0, gt=0, description="range of the uniformly distributed distances of outliers, px (description_length)"
    )
    least_noise: Annotated[float, Unit.PIXELS] = Field(
        0.03, gt=0, description="lower bound of the estimated noise of tracks, px"
    )
    parameter_price: Annotated[float, Unit.RATIO] = Field(
        0.5,
        ge=0,
        description="penalty on a parameter in nats, in logarithms of the number of observations; 0.5 is the Bayesian"
        " information criterion (description_length)",
    )
    least_silhouette: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=-1, le=1, description="best silhouette below which there is only one motion (confidences)"
    )
    affinity: HypothesisAffinityParams = HypothesisAffinityParams()
    num_resamples: Annotated[int, Unit.COUNT] = Field(
        6, ge=2, description="random halves of the frame pairs that are compared (stability)"
    )
    least_agreement: Annotated[float, Unit.RATIO] = Field(
        0.9, ge=0, le=1, description="mean adjusted Rand index of resamples that agree (stability)"
    )


class ClusteringParams(Frozen):
    """Clustering of objects into motion groups, by the affinities of several views."""

    motions: Annotated[Literal["gt", "auto"] | Annotated[int, Field(ge=1)], Unit.COUNT] = Field(
        "auto", description="number of motions including the background: gt, auto or N"
    )
    fusion: Literal["product", "sum", "coregularised"] = Field(
        "product",
        description="one kernel, the views' geometric or arithmetic mean, or co-regularised embeddings (the paper)",
    )
    grouping: Literal["linkage", "spectral"] = Field(
        "linkage", description="average linkage around the background, or k-means on the spectral embedding (the paper)"
    )
    auto: Literal["threshold", "description_length", "geometric", "confidences", "stability", "eigengap"] = Field(
        "threshold",
        description="method for the number of motions if it is not given: merging groups by affinity (threshold);"
        " minimal description length of the tracks (description_length); minimal cost of the tracks with a fixed"
        " penalty per motion (geometric); indices of cluster validity (confidences); agreement of clusters from"
        " different pairs of frames (stability); the largest gap of the spectrum (eigengap)",
    )
    count: MotionCountParams = MotionCountParams()
    threshold: Annotated[float, Unit.RATIO] = Field(
        0.5,
        gt=0,
        lt=1,
        description="minimal affinity of two groups of one motion (threshold), and minimal support for a static"
        " object, in every view (agreement) or by a rigid scene",
    )
    static: Literal["auto", "agreement", "group"] = Field(
        "auto",
        description="static objects if the number of motions is found: those static in every view, or unknown to all"
        " (agreement), the background's group (group), or (auto) the first for proposals by motion saliency or"
        " tracks and the second for all others; but with group no object is compared with a rigid scene",
    )
    co_regularisation: Annotated[float, Unit.RATIO] = Field(0.1, ge=0, description="lambda of Kumar et al. 2011")
    num_iterations: Annotated[int, Unit.COUNT] = Field(
        20, ge=1, description="maximal number of alternating updates of all views"
    )
    tolerance: Annotated[float, Unit.RATIO] = Field(
        1e-9, ge=0, description="relative growth of the objective at which the updates stop"
    )
