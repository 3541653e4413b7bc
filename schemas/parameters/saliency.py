"""Parameters of the motion saliency of a frame (weights-free)."""

from typing import Annotated, Literal

from pydantic import Field, PositiveFloat

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class SaliencyParams(Frozen):
    """Per-frame motion saliency: residual against the motion of the background, two layers or a rigid scene.

    Every pixel and px/frame below is one of the working grid, the frame reduced to `working_side`.
    """

    working_side: Annotated[int, Unit.PIXELS] = Field(
        427, ge=32, description="longer side of the working grid, px; never enlarged to it"
    )

    ransac_step: Annotated[int, Unit.PIXELS] = Field(
        12, ge=1, description="spacing of the grid that the initial homography is drawn from, px"
    )
    ransac_threshold: Annotated[float, Unit.PIXELS] = Field(
        0.5, gt=0, description="reprojection error of an inlier of the homography, px"
    )
    ransac_iterations: Annotated[int, Unit.COUNT] = Field(
        50, ge=1, description="hypotheses drawn at least; at most ten times as many"
    )
    ransac_seed: Annotated[int, Unit.SEED] = Field(
        0, ge=0, description="seed of the random draws: of the homography, the camera's motion and the ground"
    )

    affine_step: Annotated[int, Unit.PIXELS] = Field(
        6, ge=1, description="spacing of the grid that the affine fit reads, px"
    )
    affine_iterations: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="rounds of iteratively reweighted least squares"
    )
    affine_scale_floor: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.15, gt=0, description="smallest scale of the affine residuals, px/frame"
    )
    tukey_constant: Annotated[float, Unit.RATIO] = Field(
        3.75, gt=0, description="residual, in scales, from which Tukey's weight is 0"
    )

    border_band: Annotated[float, Unit.SHARE] = Field(
        0.15,
        ge=0,
        le=0.5,
        description="band along the border that is background rather than the middle, share of height",
    )
    centre_thinning: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, description="of so many places of either grid in the middle one is read"
    )

    layer_residual: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.6, gt=0, description="least residual of what a second layer may explain, px/frame"
    )
    layer_medians: Annotated[float, Unit.RATIO] = Field(
        5.0, gt=0, description="the same, in medians of the first layer's residual"
    )
    layer_area: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, le=1, description="share of the frame that must be left to explain"
    )
    layer_scales: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="second layer's residual, in its scales, that still supports it"
    )
    layer_gain: Annotated[float, Unit.RATIO] = Field(
        0.6, gt=0, le=1, description="second residual over first at which a pixel supports it"
    )
    layer_border: Annotated[float, Unit.SHARE] = Field(
        0.2, ge=0, le=1, description="share of the frame's border one supporting part covers"
    )

    background: Literal["auto", "layers", "rigid"] = Field(
        "auto", description="model of the background: one or two affine layers, a rigid scene, or whichever fits better"
    )
    selection_length: Annotated[int, Unit.FRAMES] = Field(
        64, ge=2, description="frames that share one selection of the background's model"
    )
    selection_step: Annotated[int, Unit.FRAMES] = Field(
        6, ge=1, description="frames between the frame pairs that the selection looks at"
    )
    gric_noise: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.25, gt=0, description="deviation that counts as noise in the selection, px/frame: what is not salient anyway"
    )
    gric_step: Annotated[int, Unit.PIXELS] = Field(
        8, ge=1, description="spacing of the pixels that the selection reads, px"
    )
    focals: Annotated[tuple[PositiveFloat, ...], Unit.RATIO] = Field(
        (0.5, 0.65, 0.8, 1.0, 1.25, 1.6, 2.0),
        min_length=1,
        description="focal lengths to try, longer sides of the frame",
    )
    focal_residual: Annotated[float, Unit.PIXELS] = Field(
        0.2, gt=0, description="deviation from the epipolar line that a focal pays in full, px"
    )
    focal_slack: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, description="share of the frame that another focal may explain more before it is preferred"
    )
    camera_step: Annotated[int, Unit.PIXELS] = Field(
        20, ge=1, description="spacing of the grid that the camera's motion is drawn from, px"
    )
    camera_threshold: Annotated[float, Unit.PIXELS] = Field(
        0.25, gt=0, description="epipolar error of an inlier of the camera's motion, px"
    )
    camera_iterations: Annotated[int, Unit.COUNT] = Field(
        30, ge=1, description="hypotheses drawn at least; at most ten times as many"
    )

    ground_top: Annotated[float, Unit.SHARE] = Field(
        0.6, ge=0, lt=1, description="where the frame's lower part begins, share of its height"
    )
    ground_step: Annotated[int, Unit.PIXELS] = Field(
        8, ge=1, description="spacing of the grid that the ground is fitted on, px"
    )
    ground_samples: Annotated[int, Unit.COUNT] = Field(60, ge=1, description="planes drawn")
    ground_iterations: Annotated[int, Unit.COUNT] = Field(
        5, ge=0, description="rounds of iteratively reweighted least squares"
    )
    ground_tolerance: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.3, gt=0, description="parallax by which the ground may be uneven, px/frame"
    )
    ground_relief: Annotated[float, Unit.SHARE] = Field(
        0.2, ge=0, lt=1, description="the same, as a share of the ground's own parallax"
    )
    ground_share: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="least share of the lower part that lies on a ground"
    )
    ground_agreement: Annotated[float, Unit.SHARE] = Field(
        0.9, ge=0, le=1, description="least share of pairs whose ground is nearer below"
    )
    ground_hint: Annotated[float, Unit.SHARE] = Field(
        0.6, ge=0, le=1, description="the same share, with an assumed focal length, below which no other one is tried"
    )
    ground_tilt: Annotated[float, Unit.RATIO] = Field(
        0.3, ge=0, description="steepest ground of a rigid scene, across over down the frame"
    )
    support_slope: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, description="parallax a static surface gains on the way up, a pixel, as a share of the ground's loss"
    )
    support_noise: Annotated[float, Unit.PER_FRAME] = Field(
        0.02, ge=0, description="the same for errors of the flow, px/frame a pixel"
    )

    residual_blur: Annotated[float, Unit.PIXELS] = Field(
        1.2, gt=0, description="sigma of the Gaussian over the residual, px"
    )
    floor: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.3, gt=0, description="least residual at which saliency is 1/2, px/frame"
    )
    floor_medians: Annotated[float, Unit.RATIO] = Field(2.5, ge=0, description="the same, in medians of the residual")
    floor_motion: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, description="the same, as a share of the background's motion"
    )
    otsu_percentile: Annotated[float, Unit.PERCENT] = Field(
        99.5, gt=0, le=100, description="percentile that clips the residual before Otsu"
    )

    outline_share: Annotated[float, Unit.SHARE] = Field(
        0.4, ge=0, lt=1, description="least saliency-1/2 residual as a share of the one nearby (rigid background only)"
    )
    outline_reach: Annotated[int, Unit.PIXELS] = Field(5, ge=0, description="what is nearby, px")

    gate_blur: Annotated[float, Unit.PIXELS] = Field(
        5.8, gt=0, description="sigma of the Gaussian over the colour error, px"
    )
    gate_error: Annotated[float, Unit.GREY_LEVELS] = Field(
        2.5, gt=0, description="colour error, grey levels, that opens the gate to 1 - 1/e"
    )
    # Shut wide enough to clear water; it loses dark, smooth objects, which the colours of the rest win back.
    strict_gate_error: Annotated[float, Unit.GREY_LEVELS] = Field(
        6.0, gt=0, description="the same for the strict saliency, from which colours are learnt"
    )
