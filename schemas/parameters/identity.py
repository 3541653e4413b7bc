"""Parameters of objects' identities within a section: splitting and rejoining of components."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class IdentityParams(Frozen):
    """Connected components of different motions are two objects; an object before and after an occlusion is one.

    Lengths are in px of the working grid.
    """

    min_area: Annotated[float, Unit.SHARE] = Field(
        0.001, gt=0, lt=1, description="minimal area of a part or an object in a frame, share of the frame"
    )

    split_samples: Annotated[int, Unit.COUNT] = Field(
        250, ge=12, description="approximate number of a component's pixels to which motions are fitted"
    )
    split_starts: Annotated[int, Unit.FRAMES] = Field(
        8, ge=1, description="maximal number of frames in which the search for two motions is started"
    )
    split_iterations: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, description="rounds of assigning pixels to layers and refitting the layers"
    )
    split_noise: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.5, gt=0, description="deviation from a layer's motion that is noise, px/frame"
    )
    split_noise_motion: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, description="the same, as a share of the component's speed"
    )
    split_stiffness: Annotated[float, Unit.PIXELS] = Field(
        8.0, ge=0, description="extent, px, below which a layer's motion is closer to a translation than affine"
    )
    split_outliers: Annotated[float, Unit.SHARE] = Field(
        0.1, gt=0, lt=1, description="share of a component that one motion must leave unexplained to look for a second"
    )
    split_frames: Annotated[int, Unit.FRAMES] = Field(
        5, ge=2, description="minimal number of frames in which both parts are visible"
    )
    split_explained: Annotated[float, Unit.RATIO] = Field(
        0.2, gt=0, lt=1, description="minimal share of the residual of one motion that two must explain"
    )
    split_separation: Annotated[float, Unit.RATIO] = Field(
        7.0,
        gt=0,
        description="minimal difference of two motions, in mean deviations of the parts from their own motions",
    )
    split_blur: Annotated[int, Unit.PIXELS] = Field(
        7, ge=1, description="window over which the assignment of pixels to layers is averaged, px"
    )
    split_compactness: Annotated[float, Unit.SHARE] = Field(
        0.7, gt=0, le=1, description="minimal connected share of a part"
    )
    split_travel: Annotated[float, Unit.RATIO] = Field(
        1.5,
        gt=0,
        description="minimal relative displacement of the parts while both are visible, in square roots of the smaller "
        "area: limbs move to and fro, a separate object keeps moving",
    )
    split_parts: Annotated[int, Unit.COUNT] = Field(
        4, ge=1, description="maximal number of objects of a split component"
    )

    part_distance: Annotated[float, Unit.RATIO] = Field(
        1.0,
        gt=0,
        description="distance of two pieces of an object from which on they are far from each other, in square roots of"
        " the larger area",
    )
    part_frames: Annotated[int, Unit.FRAMES] = Field(
        8, ge=1, description="frames on end for which pieces are far from each other that are different objects"
    )

    rejoin_gap: Annotated[int, Unit.FRAMES] = Field(
        10, ge=0, description="maximal number of frames of an occlusion, or of visibility on both sides of the occluder"
    )
    return_gap: Annotated[int, Unit.FRAMES] = Field(
        90, ge=0, description="maximal number of frames after which an object of the sequence is known again; 0: never"
    )
    rejoin_frames: Annotated[int, Unit.FRAMES] = Field(
        3, ge=1, description="minimal number of frames of a component that is rejoined"
    )
    rejoin_seen: Annotated[float, Unit.SHARE] = Field(
        0.85, gt=0, le=1, description="area above which an object counts as fully visible, share of its usual area"
    )
    rejoin_memory: Annotated[int, Unit.FRAMES] = Field(
        5, ge=1, description="fully visible frames over which the median velocity is taken"
    )
    rejoin_reach: Annotated[float, Unit.RATIO] = Field(
        0.5, gt=0, description="maximal distance to the predicted place, in square roots of the smaller area"
    )
    rejoin_stray: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, description="the same, as a share of the object's displacement relative to the background"
    )
    rejoin_turn: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, description="maximal change of velocity, share of the greater speed"
    )
    rejoin_drift: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        0.5, ge=0, description="additional change of velocity, px/frame"
    )
    rejoin_growth: Annotated[float, Unit.RATIO] = Field(2.5, ge=1, description="maximal ratio of the two areas")
    rejoin_colour: Annotated[float, Unit.RATIO] = Field(
        0.6, ge=0, le=1, description="minimal Bhattacharyya coefficient of the two colour histograms"
    )
