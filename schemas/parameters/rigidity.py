"""Parameters of the evidence of each track against a rigid scene."""

from typing import Annotated

from pydantic import Field, PositiveFloat, PositiveInt, field_validator, model_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.comma_separated import check_gaps, split_commas
from moseg.schemas.units import Unit


class RigidityParams(Frozen):
    """Deviation of tracks from every rigid point, over pairs of frames of a moving camera.

    A point of the static scene moves along its epipolar line, forward, no slower than the ground that it hides and no
    faster than where its surface meets the ground allows.
    """

    gaps: Annotated[tuple[PositiveInt, ...], Unit.FRAMES] = Field(
        (2, 4), description="numbers of frames between the two frames of a pair, separated by commas"
    )
    seed: Annotated[int, Unit.SEED] = Field(0, ge=0, description="seed of the random draws")

    pose_cell: Annotated[int, Unit.PIXELS] = Field(
        16, ge=1, description="side of the cells that give one track each to the fit of the camera's motion, px"
    )
    pose_threshold: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="epipolar error of an inlier of the camera's motion, px"
    )
    pose_reach: Annotated[int, Unit.FRAMES] = Field(
        4,
        ge=0,
        description="frames between the starts of pairs whose directions of travel are tried for each other, if they"
        " differ; 0: none are",
    )
    pose_iterations: Annotated[int, Unit.COUNT] = Field(
        500, ge=2, description="hypotheses drawn at most; at least half as many"
    )
    pose_inliers: Annotated[int, Unit.COUNT] = Field(
        12, ge=6, description="minimal number of inliers of the camera's motion"
    )
    focals: Annotated[tuple[PositiveFloat, ...], Unit.RATIO] = Field(
        (0.45, 0.53, 0.62, 0.73, 0.86, 1.0, 1.2, 1.4),
        min_length=1,
        description="focal lengths to try, in longer sides of the frame",
    )
    focal_prior: Annotated[float, Unit.RATIO] = Field(
        0.7, gt=0, description="focal length to prefer among those that explain the tracks alike"
    )
    focal_slack: Annotated[float, Unit.SHARE] = Field(
        0.002, ge=0, description="largest difference of mean costs of focal lengths that explain the tracks alike"
    )
    focal_gap: Annotated[int, Unit.FRAMES] = Field(
        3, ge=1, description="frames between the frames of the pairs that choose the focal length"
    )
    focal_pairs: Annotated[int, Unit.COUNT] = Field(5, ge=1, description="number of those pairs")

    noise: Annotated[float, Unit.PIXELS] = Field(
        0.5, gt=0, description="noise of a track's displacement over a pair, px"
    )
    noise_share: Annotated[float, Unit.SHARE] = Field(
        0.015, ge=0, description="the same, as a share of the displacement; both add as squares"
    )
    median_noise: Annotated[float, Unit.PIXELS] = Field(
        0.35, gt=0, description="noise of the median deviation of similar neighbours across epipolar lines, px"
    )
    median_noise_share: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, description="the same, as a share of the displacement"
    )

    ground_top: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, lt=1, description="top of the part of the frame that may show ground, share of its height"
    )
    ground_below_epipole: Annotated[float, Unit.PIXELS] = Field(
        8.0, ge=0, description="minimal distance of that part below the epipole, px"
    )
    ground_samples: Annotated[int, Unit.COUNT] = Field(300, ge=1, description="number of planes drawn")
    ground_refined: Annotated[int, Unit.COUNT] = Field(
        10, ge=1, description="number of these planes, those that agree best with the tracks, that are refined"
    )
    ground_iterations: Annotated[int, Unit.COUNT] = Field(
        20, ge=0, description="rounds of iteratively reweighted least squares of each"
    )
    ground_tolerance: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="tolerance of the ground's parallax, px"
    )
    ground_relief: Annotated[float, Unit.SHARE] = Field(
        0.03, ge=0, description="the same, as a share of the parallax; both add as squares"
    )
    ground_tilt: Annotated[float, Unit.RATIO] = Field(
        0.3, ge=0, description="maximal tilt of the ground, gradient across over gradient down the frame"
    )
    ground_share: Annotated[float, Unit.SHARE] = Field(
        0.2, ge=0, le=1, description="minimal share of the tracks of that part on the ground"
    )
    ground_points: Annotated[int, Unit.COUNT] = Field(
        20, ge=2, description="minimal number of tracks on the ground, and of tracks to look for it"
    )
    ground_slack: Annotated[float, Unit.SHARE] = Field(
        0.25, ge=0, description="noise of the ground's parallax where a track lies below it, as a share of it"
    )

    contact_parallax: Annotated[float, Unit.RATIO] = Field(
        1.15, ge=1, description="minimal parallax of an upright surface, in parallaxes of the ground that it hides"
    )
    contact_size: Annotated[float, Unit.PIXELS] = Field(
        8.0, gt=0, description="minimal size of the camera's height at the surface's distance, px"
    )
    contact_reach: Annotated[float, Unit.PIXELS] = Field(
        30.0, gt=0, description="maximal distance of neighbouring tracks of a surface, px"
    )
    contact_stretch: Annotated[float, Unit.RATIO] = Field(
        1.5, gt=0, description="weight of a distance across the frame relative to one down the frame"
    )
    contact_agreement: Annotated[float, Unit.SHARE] = Field(
        0.12, ge=0, description="maximal difference of the inverse depth of neighbouring tracks of a surface"
    )
    contact_width: Annotated[float, Unit.PIXELS] = Field(
        16.0, ge=0, description="half the width of the strip below a track in which its surface's bottom is sought, px"
    )
    contact_growth: Annotated[float, Unit.RATIO] = Field(
        0.15, ge=0, description="what is added to it, in heights of the camera at the surface's distance"
    )
    contact_noise: Annotated[float, Unit.RATIO] = Field(
        0.08, gt=0, description="noise of the height of a surface's bottom, in heights of the camera"
    )
    contact_noise_pixels: Annotated[float, Unit.PIXELS] = Field(
        2.0, ge=0, description="the same, px; both add as squares"
    )
    contact_lift: Annotated[float, Unit.RATIO] = Field(
        0.22, ge=0, description="height of a surface's bottom above the ground that needs no motion, in camera heights"
    )
    contact_margin: Annotated[float, Unit.RATIO] = Field(
        0.06,
        ge=0,
        description="smallest lift beyond what the noise of the parallax hides above the contact, camera heights",
    )
    contact_top: Annotated[float, Unit.RATIO] = Field(
        0.8, gt=0, le=1, description="height from which a surface may hang over the road, in heights of the camera"
    )

    neighbours: Annotated[int, Unit.COUNT] = Field(
        10, ge=1, description="similar neighbours of a track, itself among them"
    )
    neighbour_candidates: Annotated[int, Unit.COUNT] = Field(
        30, ge=1, description="nearest tracks among which they are chosen"
    )
    neighbour_distance: Annotated[float, Unit.PIXELS] = Field(
        40.0, gt=0, description="distance at which a neighbour's weight is 1/e, px"
    )
    neighbour_flow: Annotated[float, Unit.PIXELS] = Field(
        0.7, gt=0, description="difference of displacement at which it is 1/e, px"
    )
    neighbour_flow_share: Annotated[float, Unit.SHARE] = Field(
        0.04, ge=0, description="what is added to it, as a share of the displacement"
    )

    test_above: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=0, description="squared error from which a track's patch is compared with rigid positions"
    )
    test_blur: Annotated[float, Unit.PIXELS] = Field(
        0.7, gt=0, description="sigma of the Gaussian over the frames before the comparison, px"
    )
    test_half: Annotated[int, Unit.PIXELS] = Field(
        # A patch is a row of a map, which OpenCV samples at 32,766 columns at most.
        4,
        ge=1,
        le=90,
        description="half the side of a patch, px",
    )
    test_still_contrast: Annotated[float, Unit.RATIO] = Field(
        4.0,
        ge=0,
        description="standard deviation of a patch, in its noise, below which standing still in the picture explains it"
        " as a rigid position does where those are 4 px or more away, unless the whole frame has so little contrast: a"
        " reflection in the windscreen, or bare road that a codec repeats; 0 explains none",
    )
    test_still_frames: Annotated[tuple[PositiveInt, ...], Unit.FRAMES] = Field(
        (3, 5, 7),
        description="numbers of frames before and after the two frames of a pair, separated by commas; in one of those"
        " that the window has, the place must look the same too, or what is faint is not excused: a leg moves on",
    )
    test_span: Annotated[int, Unit.PIXELS] = Field(
        # The positions of 64 tracks are the rows of that map, of which there are as many at most.
        8,
        ge=1,
        le=255,
        description="distance of the rigid positions from the tracked one along the epipolar line, px",
    )
    test_across: Annotated[float, Unit.PIXELS] = Field(
        0.35, ge=0, description="their distance from the epipolar line, px"
    )
    test_noise: Annotated[float, Unit.GREY_LEVELS] = Field(
        2.0, gt=0, description="noise of a patch, grey levels: difference of two patches of the same surface"
    )
    test_contrast: Annotated[float, Unit.SHARE] = Field(
        0.6,
        gt=0,
        description="largest noise as a share of the frame's contrast, the mean standard deviation in a patch: dark"
        " frames have less of both",
    )
    test_limit: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="largest result of the comparison: how much worse the best rigid position is"
    )
    test_two_surfaces: Annotated[float, Unit.RATIO] = Field(
        1.2,
        ge=1,
        description="factor on the difference of a patch whose halves have two rigid positions, because two fit by"
        " chance more easily than one",
    )
    test_behind: Annotated[int, Unit.COUNT] = Field(
        # They too are rows of that map.
        24,
        ge=0,
        le=500,
        description="number of positions between the farthest static point and the track at which one of these halves"
        " may lie too, unless something tells that the track is too near: a near pole covers what is far behind it; 0:"
        " none",
    )
    test_roundness: Annotated[float, Unit.RATIO] = Field(
        0.005,
        ge=0,
        le=1,
        description="ratio of the eigenvalues of a patch's structure tensor below which it is a straight edge, of which"
        " the test proves nothing",
    )
    test_gain: Annotated[float, Unit.RATIO] = Field(10.0, gt=0, description="largest squared error at a result of 1")

    depth_noise: Annotated[float, Unit.SHARE] = Field(
        0.15, ge=0, description="noise of given depth, as a share of the parallax (only with depth)"
    )
    depth_reach: Annotated[int, Unit.PIXELS] = Field(
        2, ge=0, description="distance of the pixels whose given depth a track may have, px (only with depth)"
    )
    depth_samples: Annotated[int, Unit.COUNT] = Field(
        300, ge=1, description="pairs of tracks drawn to fit given depth to the parallax (only with depth)"
    )
    depth_refined: Annotated[int, Unit.COUNT] = Field(
        10, ge=1, description="number of these pairs, those that agree best, that are refined (only with depth)"
    )
    depth_iterations: Annotated[int, Unit.COUNT] = Field(
        20, ge=0, description="rounds of iteratively reweighted least squares of each (only with depth)"
    )
    depth_points: Annotated[int, Unit.COUNT] = Field(
        20, ge=2, description="minimal number of tracks that agree with given depth (only with depth)"
    )
    depth_share: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="minimal share of such tracks, below which the ground is used (only with depth)"
    )

    camera_slip: Annotated[float, Unit.PIXELS] = Field(
        8.0,
        ge=0,
        description="error of positions by a given camera that tracks correct, px; 0: none (only with cameras)",
    )
    camera_share: Annotated[float, Unit.SHARE] = Field(
        0.3,
        ge=0,
        le=1,
        description="minimal share of tracks that a given camera explains, below which it is fitted to tracks instead"
        " (only with cameras)",
    )
    camera_scale: Annotated[float, Unit.RATIO] = Field(
        1.5,
        ge=1,
        description="largest factor on the depth given with a camera, where more tracks agree (only with cameras)",
    )
    camera_focals: Annotated[tuple[PositiveFloat, ...], Unit.RATIO] = Field(
        (0.8, 0.86, 0.93, 1.0, 1.08, 1.16, 1.25),
        min_length=1,
        description="focal lengths to try, in given ones (only with cameras)",
    )

    _split_gaps = field_validator("gaps", "test_still_frames", mode="before")(split_commas)
    _split_focals = field_validator("focals", "camera_focals", mode="before")(split_commas)
    _check_gaps = field_validator("gaps", "test_still_frames")(check_gaps)

    @model_validator(mode="after")
    def _check_neighbours(self) -> "RigidityParams":
        """Refuse more neighbours than there are tracks to choose them from."""
        if self.neighbours > self.neighbour_candidates:
            raise ValueError("neighbours of at most neighbour_candidates")
        return self
