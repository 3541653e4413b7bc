"""Parameters of the training of the motion network on videos without labels."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class ClipParams(Frozen):
    """Evidence of a clip: tracks through a window of frames, and how they fit the background and each other."""

    reach: Annotated[int, Unit.FRAMES] = Field(
        10, ge=2, description="frames before and after the middle of a clip through which tracks are followed"
    )
    step: Annotated[int, Unit.FRAMES] = Field(8, ge=1, description="frames between the middles of clips")
    shown: Annotated[int, Unit.FRAMES] = Field(
        4, ge=1, description="frames from the middle of a clip to the two others that the network sees"
    )
    max_clips: Annotated[int, Unit.COUNT] = Field(24, ge=1, description="most clips of a video, spread evenly")
    spacing: Annotated[int, Unit.PIXELS] = Field(
        8, ge=2, description="distance of the tracks in the middle of a clip, px of the working grid"
    )
    consistency: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="forward-backward error at which a track ends, px of the working grid"
    )
    gap: Annotated[int, Unit.FRAMES] = Field(6, ge=1, description="most frames between two views of epipolar geometry")
    noise: Annotated[float, Unit.PIXELS] = Field(
        0.15, gt=0, description="least noise of flow residuals and epipolar distances, px of the working grid"
    )
    static: Annotated[float, Unit.RATIO] = Field(
        2.0, gt=0, description="largest residual and distance of a static track, relative to their noise"
    )
    moving: Annotated[float, Unit.RATIO] = Field(
        5.0, gt=0, description="least residual and distance of a moving track, relative to their noise"
    )
    neighbours: Annotated[int, Unit.COUNT] = Field(
        12, ge=6, description="tracks that a local affine motion is fitted to"
    )
    pairs: Annotated[int, Unit.COUNT] = Field(6, ge=1, description="pairs with each track")
    pair_reach: Annotated[float, Unit.SHARE] = Field(
        0.12, gt=0, le=1, description="largest distance of two tracks that are compared, of the longer side"
    )
    alike: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="scale of the affinity: residual under each other's motion, relative to its noise"
    )
    coherent: Annotated[float, Unit.SHARE] = Field(
        0.5,
        ge=0,
        le=1,
        description="share of the neighbours alike to a moving track that must move too for it to be certain",
    )


class VideoTrainingParams(Frozen):
    """Steps on clips of videos and on rendered scenes by turns, from a trained network."""

    steps: Annotated[int, Unit.COUNT] = Field(200, ge=1, description="steps of the optimizer")
    rate: Annotated[float, Unit.RATIO] = Field(1e-4, gt=0, description="largest learning rate")
    scenes: Annotated[int, Unit.COUNT] = Field(300, ge=1, description="rendered scenes that keep what was learned")
    textures: Annotated[int, Unit.COUNT] = Field(64, ge=1, description="painted textures of these scenes")
    batch: Annotated[int, Unit.COUNT] = Field(2, ge=1, description="rendered samples of a step, beside one clip")
    average: Annotated[float, Unit.SHARE] = Field(
        0.98, ge=0, lt=1, description="share of the moving average that a step keeps"
    )
    interval: Annotated[int, Unit.COUNT] = Field(100, ge=1, description="steps between validations on rendered scenes")
    replay: Annotated[float, Unit.RATIO] = Field(
        1.0, ge=0, description="weight of what the network said before of rendered samples"
    )
    targets: Annotated[float, Unit.RATIO] = Field(
        0.25, ge=0, description="weight of the tracks that are static or move"
    )
    affinity: Annotated[float, Unit.RATIO] = Field(0.5, ge=0, description="weight of the pairs of tracks")
    low_rank: Annotated[float, Unit.RATIO] = Field(0.5, ge=0, description="weight of the low rank of the tracks")
    rank: Annotated[int, Unit.COUNT] = Field(
        4, ge=3, description="rank of the tracks of one motion: 4 of a rigid one under an affine camera"
    )
    keep: Annotated[float, Unit.RATIO] = Field(
        0.2, ge=0, description="weight of what the network said before, at all pixels"
    )
    clip: ClipParams = Field(ClipParams(), description="evidence of a clip")
