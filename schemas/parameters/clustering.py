"""Parameters of the fusion of views, of the grouping of objects and of the number of motions."""

from typing import Annotated, Literal

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.affinity import HypothesisAffinityParams
from moseg.schemas.units import Unit

TRACK_METHODS = ("description_length", "geometric")
"""Ways to find the number of motions that compare how well each explains the tracks."""
READ_TRACKS = (*TRACK_METHODS, "stability")
"""Ways that read tracks; the others only read affinities."""

_FITS = frozenset(
    {"most_motions", "gap", "num_samples", "num_refits", "threshold", "truncation", "homography_ratio", "least_span"}
)
COUNT_READS = {
    "description_length": _FITS | {"outlier_range", "least_noise", "parameter_price"},
    "geometric": _FITS | {"motion_price"},
    "confidences": frozenset({"most_motions", "least_silhouette"}),
    "stability": frozenset({"most_motions", "gap", "affinity", "num_resamples", "least_agreement"}),
}
"""Parameters of `MotionCountParams` that each way to find the number of motions reads; the other ways read none."""


class MotionCountParams(Frozen):
    """How clusterings into 1, 2, ... motions are compared where the number is not given."""

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
        description="a pair shows no parallax where a homography explains its widest object: where it has this share of"
        " the fundamental matrix's inliers",
    )
    least_span: Annotated[float, Unit.RATIO] = Field(
        0.5,
        ge=0,
        description="spread of the widest object, in that of all tracks, below which parallax is taken for granted",
    )
    truncation: Annotated[float, Unit.PIXELS] = Field(
        0.5, gt=0, description="distance from which an observation counts as far (affine fits) or costs 1, px"
    )
    motion_price: Annotated[float, Unit.SHARE] = Field(
        0.02, ge=0, description="cost of a motion, in shares of observations (geometric)"
    )
    outlier_range: Annotated[float, Unit.PIXELS] = Field(
        5.0, gt=0, description="range over which the distances of outliers are spread, px (description_length)"
    )
    least_noise: Annotated[float, Unit.PIXELS] = Field(
        0.03, gt=0, description="noise of tracks below which none is believed, px"
    )
    parameter_price: Annotated[float, Unit.RATIO] = Field(
        0.5,
        ge=0,
        description="nats of a parameter in logarithms of the number of observations; 0.5 is the Bayesian information"
        " criterion (description_length)",
    )
    least_silhouette: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=-1, le=1, description="best silhouette below which there is one motion only (confidences)"
    )
    affinity: HypothesisAffinityParams = HypothesisAffinityParams()
    num_resamples: Annotated[int, Unit.COUNT] = Field(
        6, ge=2, description="random halves of the frame pairs that are compared (stability)"
    )
    least_agreement: Annotated[float, Unit.RATIO] = Field(
        0.9, ge=0, le=1, description="mean adjusted Rand index of resamples that agree (stability)"
    )


class ClusteringParams(Frozen):
    """How affinities of several views become motion groups."""

    motions: Annotated[Literal["gt", "auto"] | Annotated[int, Field(ge=1)], Unit.COUNT] = Field(
        "auto", description="number of motions with the background: gt, auto or N"
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
        description="how the number of motions is found where it is not given: groups merge while they are alike"
        " (threshold); what describes the tracks in the fewest nats (description_length), or explains them at a fixed"
        " price for each motion (geometric); the clearest clusters (confidences); clusters that come back in other"
        " pairs of frames (stability); the largest gap of the spectrum (eigengap)",
    )
    count: MotionCountParams = MotionCountParams()
    threshold: Annotated[float, Unit.RATIO] = Field(
        0.5,
        gt=0,
        lt=1,
        description="least affinity at which two groups are one motion (threshold), and least support for static in"
        " every view at which an object is dropped (agreement)",
    )
    static: Literal["auto", "agreement", "group"] = Field(
        "auto",
        description="what is static where the number of motions is found: objects of which every view says so, or that"
        " none knows (agreement), the background's group (group), or (auto) the first for proposals cut out because"
        " they move (saliency) and the second for all others",
    )
    co_regularisation: Annotated[float, Unit.RATIO] = Field(0.1, ge=0, description="lambda of Kumar et al. 2011")
    num_iterations: Annotated[int, Unit.COUNT] = Field(20, ge=1, description="most alternating updates of all views")
    tolerance: Annotated[float, Unit.RATIO] = Field(
        1e-9, ge=0, description="relative growth of the objective at which the updates stop"
    )
