"""Parameters of objects' identities within a section: which components to split, and which to rejoin."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class IdentityParams(Frozen):
    """Components that touch but move apart are two objects; one that hides and comes out again is one.

    Lengths are in px of the working grid.
    """

    min_area: Annotated[float, Unit.SHARE] = Field(
        0.001, gt=0, lt=1, description="least area in a frame of what counts as a part or an object, share of the frame"
    )

    split_samples: Annotated[int, Unit.COUNT] = Field(
        250, ge=12, description="pixels of a component that motions are fitted to, about"
    )
    split_starts: Annotated[int, Unit.FRAMES] = Field(
        8, ge=1, description="frames at most in which the search for two motions may begin"
    )
    split_iterations: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, description="rounds of assigning pixels to layers and refitting these"
    )
    split_noise: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.5, gt=0, description="deviation from a layer's motion that is noise, px/frame"
    )
    split_noise_motion: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, description="the same, as a share of the component's speed"
    )
    split_stiffness: Annotated[float, Unit.PIXELS] = Field(
        8.0, ge=0, description="extent, px, under which a layer's motion is rather a translation than affine"
    )
    split_outliers: Annotated[float, Unit.SHARE] = Field(
        0.1, gt=0, lt=1, description="share of a component that one motion must leave unexplained to look for a second"
    )
    split_frames: Annotated[int, Unit.FRAMES] = Field(5, ge=2, description="frames in which both parts must be seen")
    split_explained: Annotated[float, Unit.RATIO] = Field(
        0.2, gt=0, lt=1, description="least part of the misfit of one motion that two must explain"
    )
    split_separation: Annotated[float, Unit.RATIO] = Field(
        7.0, gt=0, description="least difference of two motions, in mean deviations of the parts from their own"
    )
    split_blur: Annotated[int, Unit.PIXELS] = Field(
        7, ge=1, description="window over which pixels decide together for a layer, px"
    )
    split_compactness: Annotated[float, Unit.SHARE] = Field(
        0.7, gt=0, le=1, description="least share of a part that is connected"
    )
    split_travel: Annotated[float, Unit.RATIO] = Field(
        1.5,
        gt=0,
        description="least way between the parts while both are seen, in square roots of the smaller one's area: limbs "
        "swing to and fro, an object of its own moves on",
    )
    split_parts: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, description="objects that a component is split into at most"
    )

    rejoin_gap: Annotated[int, Unit.FRAMES] = Field(
        10, ge=0, description="frames that an object may be out of sight, or be seen on both sides of what hides it"
    )
    rejoin_frames: Annotated[int, Unit.FRAMES] = Field(
        3, ge=1, description="frames that a component must last to be rejoined"
    )
    rejoin_seen: Annotated[float, Unit.SHARE] = Field(
        0.85, gt=0, le=1, description="area above which an object counts as in full view, share of its usual area"
    )
    rejoin_memory: Annotated[int, Unit.FRAMES] = Field(
        5, ge=1, description="frames in full view that its velocity is the median of"
    )
    rejoin_reach: Annotated[float, Unit.RATIO] = Field(
        0.5, gt=0, description="distance to the predicted place allowed, in square roots of the smaller area"
    )
    rejoin_stray: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, description="the same, as a share of the object's way past the background"
    )
    rejoin_turn: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, description="change of velocity allowed, share of the greater speed"
    )
    rejoin_drift: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.5, ge=0, description="change of velocity allowed besides, px/frame"
    )
    rejoin_growth: Annotated[float, Unit.RATIO] = Field(2.5, ge=1, description="ratio of the two areas at most")
    rejoin_colour: Annotated[float, Unit.RATIO] = Field(
        0.6, ge=0, le=1, description="least Bhattacharyya coefficient of the two colour histograms"
    )
