"""Parameters of motion saliency, of the object proposals taken from it and of their linking (weights-free)."""

from pydantic import Field

from schemas.frozen import Frozen


class SaliencyParams(Frozen):
    """Per-frame motion saliency: residual against a two-layer background motion.

    Every pixel and px/frame below is one of the working grid, the frame reduced to `working_side`.
    """

    working_side: int = Field(427, ge=32, description="longer side of the working grid, px; never enlarged to it")

    ransac_step: int = Field(12, ge=1, description="spacing of the grid that the initial homography is drawn from, px")
    ransac_threshold: float = Field(0.5, gt=0, description="reprojection error of an inlier of the homography, px")
    ransac_iterations: int = Field(100, ge=1, description="hypotheses drawn at least; at most ten times as many")
    ransac_seed: int = Field(0, ge=0, description="seed of the homography's random draws")

    affine_step: int = Field(4, ge=1, description="spacing of the grid that the affine fit reads, px")
    affine_iterations: int = Field(8, ge=1, description="rounds of iteratively reweighted least squares")
    affine_scale_floor: float = Field(0.15, gt=0, description="smallest scale of the affine residuals, px/frame")
    tukey_constant: float = Field(3.75, gt=0, description="residual, in scales, from which Tukey's weight is 0")

    layer_residual: float = Field(0.6, gt=0, description="least residual of what a second layer may explain, px/frame")
    layer_medians: float = Field(5.0, gt=0, description="the same, in medians of the first layer's residual")
    layer_area: float = Field(0.05, ge=0, le=1, description="share of the frame that must be left to explain")
    layer_scales: float = Field(3.0, gt=0, description="second layer's residual, in its scales, that still supports it")
    layer_gain: float = Field(0.6, gt=0, le=1, description="second residual over first at which a pixel supports it")
    layer_border: float = Field(0.2, ge=0, le=1, description="share of the frame's border one supporting part covers")

    residual_blur: float = Field(1.2, gt=0, description="sigma of the Gaussian over the residual, px")
    floor: float = Field(0.3, gt=0, description="least residual at which saliency is 1/2, px/frame")
    floor_medians: float = Field(2.5, ge=0, description="the same, in medians of the residual")
    floor_motion: float = Field(0.05, ge=0, description="the same, as a share of the background's motion")
    otsu_percentile: float = Field(99.5, gt=0, le=100, description="percentile that clips the residual before Otsu")

    # Wider gates (4 grey levels) clear more water but lose dark, smooth objects unless a colour model wins them back.
    gate_blur: float = Field(5.8, gt=0, description="sigma of the Gaussian over the colour error, px")
    gate_error: float = Field(2.5, gt=0, description="colour error, grey levels, that opens the gate to 1 - 1/e")


class ProposalParams(Frozen):
    """Accumulation of saliency along the flow and its space-time components."""

    memory: float = Field(0.85, ge=0, lt=1, description="weight of the past where the flow is consistent")
    consistency_floor: float = Field(0.5, ge=0, le=1, description="least consistency that the memory is scaled with")
    reliability_floor: float = Field(0.1, gt=0, le=1, description="weight of a frame's saliency where its flow fails")
    consistency_relative: float = Field(0.02, ge=0, description="forward-backward error allowed, share of |flow|^2")
    consistency_absolute: float = Field(0.5, gt=0, description="forward-backward error allowed, (px/frame)^2")

    threshold: float = Field(
        0.6, gt=0, lt=1, description="accumulated saliency above which a pixel belongs to an object"
    )
    sharpness: float = Field(
        1.5, gt=0, description="slope from the logit of saliency to the logit of the score's weight"
    )
    border_share: float = Field(
        0.4, gt=0, le=1, description="share of outline on the frame's border that voids a score"
    )
    score_ratio: float = Field(0.1, ge=0, le=1, description="objects below this share of the best score are dropped")
    min_area: float = Field(0.0005, ge=0, le=1, description="least mean area over its frames, share of the frame")
    max_objects: int = Field(16, ge=1, le=65535, description="objects kept at most, best score first")


class LinkingParams(Frozen):
    """Identities of objects across sections that share frames."""

    min_iou: float = Field(
        0.3, gt=0, le=1, description="least overlap (IoU over the shared frames) of one object in two"
    )
