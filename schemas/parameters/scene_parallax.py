"""Parameters of the parallax of a stretch of video, from which the source of its proposals is chosen."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class SceneParallaxParams(Frozen):
    """Corners tracked over frame pairs of a stretch, a rigid scene fitted to them, and the choice between sources.

    The fit, the focal length and the noise are those of `rigidity`.
    """

    stretch_length: Annotated[int, Unit.FRAMES] = Field(
        64, ge=8, description="frames of a stretch; a rest shorter than half of it joins the one before"
    )
    num_pairs: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="frame pairs spread over a stretch of this length or more"
    )
    min_pairs: Annotated[int, Unit.COUNT] = Field(4, ge=1, description="frame pairs of the shortest stretch")
    pair_gap: Annotated[int, Unit.FRAMES] = Field(4, ge=1, description="frames between the two frames of a pair")
    num_corners: Annotated[int, Unit.COUNT] = Field(800, ge=50, description="corners tracked over a pair")
    corner_quality: Annotated[float, Unit.SHARE] = Field(
        0.001, gt=0, lt=1, description="minimal corner response, as a share of the largest one"
    )
    corner_spacing: Annotated[float, Unit.PIXELS] = Field(12.0, ge=1, description="distance between corners, px")
    window: Annotated[int, Unit.PIXELS] = Field(15, ge=5, le=255, description="side of the Lucas-Kanade window, px")
    pyramid_levels: Annotated[int, Unit.COUNT] = Field(4, ge=0, description="pyramid levels above full resolution")
    forward_backward: Annotated[float, Unit.PIXELS] = Field(
        0.7, gt=0, description="maximal forward-backward error of a corner from frame to frame, px"
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(40, ge=16, description="tracks below which a pair is no evidence")
    min_motion: Annotated[float, Unit.PIXELS] = Field(
        1.0, ge=0, description="median displacement below which the camera counts as still over a pair, px"
    )
    rest_motion: Annotated[float, Unit.PIXELS] = Field(
        0.15, ge=0, description="displacement below which a corner is at rest over a pair, px"
    )
    rest_share: Annotated[float, Unit.SHARE] = Field(
        0.4,
        gt=0,
        le=1,
        description="share of corners at rest at two opposite borders from which the camera counts as still over a "
        "pair, whatever else moves",
    )
    plane_slack: Annotated[float, Unit.RATIO] = Field(
        1.4, gt=0, description="error allowed under the homography, in those allowed under the rigid scene"
    )
    min_moving: Annotated[float, Unit.SHARE] = Field(
        0.5, gt=0, le=1, description="minimal share of the pairs over which the camera moves, for tracks"
    )
    min_gain: Annotated[float, Unit.SHARE] = Field(
        0.22, ge=0, le=1, description="minimal median share of tracks that only the rigid scene explains, for tracks"
    )
    min_ahead_gain: Annotated[float, Unit.SHARE] = Field(
        0.05,
        ge=0,
        le=1,
        description="the same for objects to be compared with a rigid scene, where the camera moves ahead; elsewhere"
        " it is min_gain",
    )
    min_inside: Annotated[float, Unit.SHARE] = Field(
        0.6, ge=0, le=1, description="minimal share of pairs with the epipole inside the frame, for tracks"
    )
    max_wander_deg: Annotated[float, Unit.DEGREES] = Field(
        2.5,
        gt=0,
        le=180,
        description="maximal median angle between the pairs' headings and their middle, for tracks",
    )
