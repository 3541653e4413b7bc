"""Parameters of the motion saliency of a frame (weights-free)."""

from typing import Literal

from pydantic import Field, PositiveFloat

from schemas.frozen import Frozen


class SaliencyParams(Frozen):
    """Per-frame motion saliency: residual against the motion of the background, two layers or a rigid scene.

    Every pixel and px/frame below is one of the working grid, the frame reduced to `working_side`.
    """

    working_side: int = Field(427, ge=32, description="longer side of the working grid, px; never enlarged to it")

    ransac_step: int = Field(12, ge=1, description="spacing of the grid that the initial homography is drawn from, px")
    ransac_threshold: float = Field(0.5, gt=0, description="reprojection error of an inlier of the homography, px")
    ransac_iterations: int = Field(50, ge=1, description="hypotheses drawn at least; at most ten times as many")
    ransac_seed: int = Field(
        0, ge=0, description="seed of the random draws: of the homography, the camera's motion and the ground"
    )

    affine_step: int = Field(6, ge=1, description="spacing of the grid that the affine fit reads, px")
    affine_iterations: int = Field(8, ge=1, description="rounds of iteratively reweighted least squares")
    affine_scale_floor: float = Field(0.15, gt=0, description="smallest scale of the affine residuals, px/frame")
    tukey_constant: float = Field(3.75, gt=0, description="residual, in scales, from which Tukey's weight is 0")

    border_band: float = Field(
        0.15,
        ge=0,
        le=0.5,
        description="band along the border that is background rather than the middle, share of height",
    )
    centre_thinning: int = Field(3, ge=1, description="of so many places of either grid in the middle one is read")

    layer_residual: float = Field(0.6, gt=0, description="least residual of what a second layer may explain, px/frame")
    layer_medians: float = Field(5.0, gt=0, description="the same, in medians of the first layer's residual")
    layer_area: float = Field(0.05, ge=0, le=1, description="share of the frame that must be left to explain")
    layer_scales: float = Field(3.0, gt=0, description="second layer's residual, in its scales, that still supports it")
    layer_gain: float = Field(0.6, gt=0, le=1, description="second residual over first at which a pixel supports it")
    layer_border: float = Field(0.2, ge=0, le=1, description="share of the frame's border one supporting part covers")

    background: Literal["auto", "layers", "rigid"] = Field(
        "auto", description="model of the background: one or two affine layers, a rigid scene, or whichever fits better"
    )
    selection_length: int = Field(64, ge=2, description="frames that share one selection of the background's model")
    selection_step: int = Field(6, ge=1, description="frames between the frame pairs that the selection looks at")
    gric_noise: float = Field(
        0.25, gt=0, description="deviation that counts as noise in the selection, px/frame: what is not salient anyway"
    )
    gric_step: int = Field(8, ge=1, description="spacing of the pixels that the selection reads, px")
    focals: tuple[PositiveFloat, ...] = Field(
        (0.5, 0.65, 0.8, 1.0, 1.25, 1.6, 2.0),
        min_length=1,
        description="focal lengths to try, longer sides of the frame",
    )
    focal_residual: float = Field(
        0.2, gt=0, description="deviation from the epipolar line that a focal pays in full, px"
    )
    focal_slack: float = Field(
        0.01, ge=0, description="share of the frame that another focal may explain more before it is preferred"
    )
    camera_step: int = Field(20, ge=1, description="spacing of the grid that the camera's motion is drawn from, px")
    camera_threshold: float = Field(0.25, gt=0, description="epipolar error of an inlier of the camera's motion, px")
    camera_iterations: int = Field(30, ge=1, description="hypotheses drawn at least; at most ten times as many")

    ground_top: float = Field(0.6, ge=0, lt=1, description="where the frame's lower part begins, share of its height")
    ground_step: int = Field(8, ge=1, description="spacing of the grid that the ground is fitted on, px")
    ground_samples: int = Field(60, ge=1, description="planes drawn")
    ground_iterations: int = Field(5, ge=0, description="rounds of iteratively reweighted least squares")
    ground_tolerance: float = Field(0.3, gt=0, description="parallax by which the ground may be uneven, px/frame")
    ground_relief: float = Field(0.2, ge=0, lt=1, description="the same, as a share of the ground's own parallax")
    ground_share: float = Field(0.5, ge=0, le=1, description="least share of the lower part that lies on a ground")
    ground_agreement: float = Field(0.9, ge=0, le=1, description="least share of pairs whose ground is nearer below")
    ground_hint: float = Field(
        0.6, ge=0, le=1, description="the same share, with an assumed focal length, below which no other one is tried"
    )
    ground_tilt: float = Field(0.3, ge=0, description="steepest ground of a rigid scene, across over down the frame")
    support_slope: float = Field(
        0.5, ge=0, description="parallax a static surface gains on the way up, a pixel, as a share of the ground's loss"
    )
    support_noise: float = Field(0.02, ge=0, description="the same for errors of the flow, px/frame a pixel")

    residual_blur: float = Field(1.2, gt=0, description="sigma of the Gaussian over the residual, px")
    floor: float = Field(0.3, gt=0, description="least residual at which saliency is 1/2, px/frame")
    floor_medians: float = Field(2.5, ge=0, description="the same, in medians of the residual")
    floor_motion: float = Field(0.05, ge=0, description="the same, as a share of the background's motion")
    otsu_percentile: float = Field(99.5, gt=0, le=100, description="percentile that clips the residual before Otsu")

    outline_share: float = Field(
        0.4, ge=0, lt=1, description="least saliency-1/2 residual as a share of the one nearby (rigid background only)"
    )
    outline_reach: int = Field(5, ge=0, description="what is nearby, px")

    gate_blur: float = Field(5.8, gt=0, description="sigma of the Gaussian over the colour error, px")
    gate_error: float = Field(2.5, gt=0, description="colour error, grey levels, that opens the gate to 1 - 1/e")
    # Shut wide enough to clear water; it loses dark, smooth objects, which the colours of the rest win back.
    strict_gate_error: float = Field(
        6.0, gt=0, description="the same for the strict saliency, from which colours are learnt"
    )
