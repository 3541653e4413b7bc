"""Parameters of the motion saliency of a frame (weights-free)."""

from typing import Annotated, Literal

from pydantic import Field, PositiveFloat, field_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.comma_separated import split_commas
from moseg.schemas.units import Unit


class SaliencyParams(Frozen):
    """Per-frame motion saliency: residual to the motion of the background, of up to two layers or a rigid scene.

    All lengths in px and px/frame below refer to the working grid, the frame reduced or enlarged to `working_side`.
    """

    working_side: Annotated[int, Unit.PIXELS] = Field(
        427,
        ge=32,
        description="longer side of the working grid, px; small frames are enlarged to it, to twice their size at most",
    )

    ransac_step: Annotated[int, Unit.PIXELS] = Field(
        12, ge=1, description="spacing of the grid from which the initial homography is drawn, px"
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

    affine_step: Annotated[int, Unit.PIXELS] = Field(6, ge=1, description="spacing of the grid for the affine fit, px")
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
        description="band along the border that is more likely background than the middle, share of height",
    )
    rest_motion: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.05, ge=0, description="flow below which a pixel is at rest, px/frame; 0 finds no camera at rest"
    )
    rest_gradient: Annotated[float, Unit.GREY_LEVELS] = Field(
        3.0, ge=0, description="gradient from which a pixel shows whether it is at rest, grey levels per px"
    )
    rest_share: Annotated[float, Unit.SHARE] = Field(
        0.4,
        gt=0,
        le=1,
        description="share of such pixels at rest at two opposite borders from which the camera is at rest, and the "
        "background has no motion",
    )
    centre_thinning: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, description="factor by which both grids are thinned in the middle of the frame"
    )

    layer_residual: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.6, gt=0, description="minimal residual of pixels that a second layer may explain, px/frame"
    )
    layer_medians: Annotated[float, Unit.RATIO] = Field(
        5.0, gt=0, description="the same, in medians of the first layer's residual"
    )
    layer_area: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, le=1, description="minimal share of the frame with such residuals"
    )
    layer_scales: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="maximal residual of a pixel that supports the second layer, in scales of that layer"
    )
    layer_gain: Annotated[float, Unit.RATIO] = Field(
        0.6, gt=0, le=1, description="ratio of second to first residual below which a pixel supports the second layer"
    )
    layer_border: Annotated[float, Unit.SHARE] = Field(
        0.2, ge=0, le=1, description="minimal share of the frame's border in one connected supporting region"
    )

    background: Literal["auto", "layers", "rigid"] = Field(
        "auto", description="model of the background: one or two affine layers, a rigid scene, or whichever fits better"
    )
    selection_length: Annotated[int, Unit.FRAMES] = Field(
        64, ge=2, description="frames with a common selection of the background's model"
    )
    selection_step: Annotated[int, Unit.FRAMES] = Field(
        6, ge=1, description="frames between the frame pairs that the selection reads"
    )
    gric_noise: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.25, gt=0, description="noise in the selection, px/frame: deviations that are not salient in any case"
    )
    gric_step: Annotated[int, Unit.PIXELS] = Field(
        8, ge=1, description="spacing of the pixels that the selection reads, px"
    )
    focals: Annotated[tuple[PositiveFloat, ...], Unit.RATIO] = Field(
        (0.5, 0.65, 0.8, 1.0, 1.25, 1.6, 2.0),
        min_length=1,
        description="focal lengths to try, in longer sides of the frame",
    )
    focal_residual: Annotated[float, Unit.PIXELS] = Field(
        0.2, gt=0, description="deviation from the epipolar line at which the cost of a focal length is truncated, px"
    )
    focal_slack: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, description="additional share of the frame that another focal length must explain to be preferred"
    )
    camera_step: Annotated[int, Unit.PIXELS] = Field(
        20, ge=1, description="spacing of the grid from which the camera's motion is drawn, px"
    )
    camera_threshold: Annotated[float, Unit.PIXELS] = Field(
        0.25, gt=0, description="epipolar error of an inlier of the camera's motion, px"
    )
    camera_iterations: Annotated[int, Unit.COUNT] = Field(
        30, ge=1, description="hypotheses drawn at least; at most ten times as many"
    )

    ground_top: Annotated[float, Unit.SHARE] = Field(
        0.6, ge=0, lt=1, description="top of the frame's lower part, share of its height"
    )
    ground_step: Annotated[int, Unit.PIXELS] = Field(
        8, ge=1, description="spacing of the grid for the fit of the ground, px"
    )
    ground_samples: Annotated[int, Unit.COUNT] = Field(60, ge=1, description="number of planes drawn")
    ground_iterations: Annotated[int, Unit.COUNT] = Field(
        5, ge=0, description="rounds of iteratively reweighted least squares"
    )
    ground_tolerance: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.3, gt=0, description="tolerance of the ground's parallax for unevenness, px/frame"
    )
    ground_relief: Annotated[float, Unit.SHARE] = Field(
        0.2, ge=0, lt=1, description="the same, as a share of the ground's own parallax"
    )
    ground_share: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="minimal share of the lower part on the ground"
    )
    ground_agreement: Annotated[float, Unit.SHARE] = Field(
        0.9, ge=0, le=1, description="minimal share of pairs whose ground is nearer at the bottom"
    )
    ground_hint: Annotated[float, Unit.SHARE] = Field(
        0.6, ge=0, le=1, description="the same share for an assumed focal length, below which no other one is tried"
    )
    ground_tilt: Annotated[float, Unit.RATIO] = Field(
        0.3,
        ge=0,
        description="maximal tilt of the ground of a rigid scene, gradient across over gradient down the frame",
    )
    support_slope: Annotated[float, Unit.SHARE] = Field(
        0.5,
        ge=0,
        description="increase of a static surface's parallax upwards, per pixel, as a share of the ground's decrease",
    )
    support_noise: Annotated[float, Unit.PER_FRAME] = Field(
        0.02, ge=0, description="the same for errors of the flow, px/frame per pixel"
    )

    residual_blur: Annotated[float, Unit.PIXELS] = Field(
        1.2, gt=0, description="sigma of the Gaussian over the residual, px"
    )
    floor: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.3, gt=0, description="lower bound of the residual at which saliency is 1/2, px/frame"
    )
    floor_medians: Annotated[float, Unit.RATIO] = Field(2.5, ge=0, description="the same, in medians of the residual")
    floor_motion: Annotated[float, Unit.SHARE] = Field(
        0.05, ge=0, description="the same, as a share of the background's motion"
    )
    otsu_percentile: Annotated[float, Unit.PERCENT] = Field(
        99.5, gt=0, le=100, description="percentile at which the residual is clipped before Otsu's threshold"
    )

    outline_share: Annotated[float, Unit.SHARE] = Field(
        0.4,
        ge=0,
        lt=1,
        description="minimal residual of saliency 1/2, as a share of that nearby (rigid background, or at rest)",
    )
    outline_reach: Annotated[int, Unit.PIXELS] = Field(5, ge=0, description="distance that counts as nearby, px")

    gate_blur: Annotated[float, Unit.PIXELS] = Field(
        5.8, gt=0, description="sigma of the Gaussian over the colour error, px"
    )
    gate_error: Annotated[float, Unit.GREY_LEVELS] = Field(
        2.5, gt=0, description="colour error at which the gate is 1 - 1/e, grey levels"
    )
    # High enough to remove water; it also removes dark, smooth objects, which the colours of the others recover.
    strict_gate_error: Annotated[float, Unit.GREY_LEVELS] = Field(
        6.0, gt=0, description="the same for the strict saliency, from which colours are learnt"
    )

    _split_focals = field_validator("focals", mode="before")(split_commas)
