"""Parameters of objects from tracks: from the evidence of frame pairs to objects that are kept or dropped."""

from typing import Annotated

from pydantic import Field

from moseg.schemas.frozen import Frozen
from moseg.schemas.units import Unit


class TrackFieldParams(Frozen):
    """Evidence of each track over all frame pairs, and its agreement with neighbours that move alike.

    Errors are in units of their tolerance: 1 is what a static point may well have.
    """

    max_error: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="error of a track in a frame pair, in tolerances, beyond which it counts no more"
    )
    static_error: Annotated[float, Unit.RATIO] = Field(
        1.2, ge=0, description="mean squared error of a track, in squared tolerances, above which it rather moves"
    )
    static_median_error: Annotated[float, Unit.RATIO] = Field(
        0.8, ge=0, description="the same for the median error of the track and its similar neighbours"
    )
    max_pairs: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="independent frame pairs of a track: more of them add no evidence"
    )
    num_neighbours: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="nearest tracks in a frame that are compared with a track"
    )
    gap: Annotated[int, Unit.FRAMES] = Field(2, ge=1, description="frames over which the motions are compared")
    distance: Annotated[float, Unit.PIXELS] = Field(
        30.0, gt=0, description="distance of two tracks at which their coupling falls to 1/e, px"
    )
    tolerance: Annotated[float, Unit.PIXELS] = Field(
        0.7, gt=0, description="difference of two motions over the gap at which the coupling falls to 1/e, px"
    )
    relative_tolerance: Annotated[float, Unit.SHARE] = Field(
        0.04, ge=0, description="addition to it, as a share of the track's motion"
    )
    coupling: Annotated[float, Unit.RATIO] = Field(
        2.0, ge=0, description="weight of the neighbours' states relative to a track's own evidence"
    )
    num_rounds: Annotated[int, Unit.COUNT] = Field(30, ge=0, description="updates of the mean field, each by half")


class TrackObjectParams(Frozen):
    """Objects of tracks that move alike, and the evidence that an object must have to be proposed."""

    radius: Annotated[float, Unit.PIXELS] = Field(
        30.0, gt=0, description="largest distance in a frame of two tracks that are joined, px"
    )
    num_neighbours: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="nearest moving tracks in a frame that are compared with a moving track"
    )
    gap: Annotated[int, Unit.FRAMES] = Field(2, ge=1, description="frames over which the motions are compared")
    tolerance: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="difference of two motions over the gap at which their similarity falls to 1/e, px"
    )
    relative_tolerance: Annotated[float, Unit.SHARE] = Field(
        0.08, ge=0, description="addition to it, as a share of the larger motion"
    )
    spread_tolerance: Annotated[float, Unit.PER_FRAME] = Field(
        0.02, ge=0, description="addition to it per frame of the gap, as a share of the distance of the two tracks"
    )
    min_similarity: Annotated[float, Unit.RATIO] = Field(
        0.3, gt=0, le=1, description="mean similarity, over the frames in which they are neighbours, of joined tracks"
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(5, ge=1, description="smallest number of tracks of an object")
    min_observations: Annotated[int, Unit.COUNT] = Field(
        20, ge=1, description="smallest number of observations of an object, summed over its tracks and frames"
    )
    max_error: Annotated[float, Unit.RATIO] = Field(
        12.0, gt=0, description="median error in a frame pair, in tolerances, beyond which it adds nothing to the score"
    )
    min_score: Annotated[float, Unit.RATIO] = Field(
        400.0, ge=0, description="smallest score of a moving object: its summed errors times its mean rigidity test"
    )
    min_test: Annotated[float, Unit.RATIO] = Field(
        0.7,
        ge=-1,
        le=3,
        description="smallest mean rigidity test of a moving object: how much worse the best rigid position explains"
        " its patches than the tracked one",
    )
