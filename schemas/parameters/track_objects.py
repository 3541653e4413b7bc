"""Parameters of objects from tracks: from the evidence of frame pairs to objects that are kept or dropped."""

from typing import Annotated, Literal

from pydantic import Field, field_validator

from moseg.schemas.choices import ChoiceOf
from moseg.schemas.frozen import Frozen, with_defaults
from moseg.schemas.parameters.comma_separated import check_models, split_commas
from moseg.schemas.parameters.trajectories import (
    EnergyParams,
    KernelParams,
    PieceParams,
    SeparationParams,
    TrajectoryClusteringParams,
)
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


class CandidateParams(Frozen):
    """Candidates: moving tracks joined because they are near and move alike. Scores are per frame, of 1.7 pairs."""

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
    min_tracks: Annotated[int, Unit.COUNT] = Field(3, ge=1, description="smallest number of tracks of a candidate")
    min_observations: Annotated[int, Unit.COUNT] = Field(
        9, ge=1, description="smallest number of observations of a candidate, summed over its tracks and frames"
    )
    max_error: Annotated[float, Unit.RATIO] = Field(
        12.0,
        gt=0,
        description="median error in a frame pair, in tolerances, beyond which it adds nothing to the score; the patch"
        " test limits errors to 5.5 by default, the square root of rigidity.test_gain times rigidity.test_limit",
    )
    min_score: Annotated[float, Unit.RATIO] = Field(4.0, ge=0, description="smallest score of a candidate")
    min_test: Annotated[float, Unit.RATIO] = Field(
        0.5, ge=-1, le=3, description="smallest mean rigidity test of a candidate"
    )


@with_defaults(
    gaps=(3,),
    least_unit=0.15,
    cut_weight=0.85,
    coding_weight=0.0,
    motion_weight=0.01,
    chance_weight=0.0,
    free_motions=0,
)
class TrackEnergyParams(EnergyParams):
    """Energy of a grouping of dense tracks: without coding length, whose effects on them are not measured."""


@with_defaults(counts=(6, 8, 10), merged="middle")
class TrackPieceParams(PieceParams):
    """Pieces that groupings of dense tracks are merged from."""


@with_defaults(min_gap=0.0)
class TrackSeparationParams(SeparationParams):
    """Separation of the motions of dense tracks, which need not be apart: effects of that are not measured."""


@with_defaults(num_refined=0, min_tracks=1)
class TrackClusteringParams(TrajectoryClusteringParams):
    """Clustering of a sample of dense tracks, whose number of motions is found from one draw of hypotheses."""

    auto: Literal["energy", "description_length", "geometric", "confidences", "eigengap"] = Field(
        "energy",
        description="method for the number of motions: minimal energy, the methods of clustering.auto on the best"
        " groupings but stability, which compares several draws, or the largest gap of the mean kernel's spectrum",
    )
    energy: TrackEnergyParams = TrackEnergyParams()
    pieces: TrackPieceParams = TrackPieceParams()
    separation: TrackSeparationParams = TrackSeparationParams()


class TrackGroupParams(Frozen):
    """Motion groups of balanced samples of static tracks and of the candidates' tracks."""

    seed: Annotated[int, Unit.SEED] = Field(
        0, ge=0, description="seed of the random draws, of the sample and of the grouping; nothing else depends on it"
    )
    num_samples: Annotated[int, Unit.COUNT] = Field(
        5,
        ge=1,
        le=1000,
        description="number of samples; the grouping that agrees most with those of the others is taken",
    )
    max_moving: Annotated[int, Unit.COUNT] = Field(250, ge=1, description="largest number of the candidates' tracks")
    max_static: Annotated[int, Unit.COUNT] = Field(120, ge=1, description="largest number of static tracks")
    min_moving: Annotated[int, Unit.COUNT] = Field(
        5, ge=1, description="smallest number of the candidates' tracks; with fewer, candidates are not regrouped"
    )
    min_static: Annotated[int, Unit.COUNT] = Field(10, ge=1, description="the same of static tracks")
    min_moving_life: Annotated[int, Unit.FRAMES] = Field(
        4, ge=2, description="smallest number of frames of a sampled track of a candidate"
    )
    min_static_life: Annotated[int, Unit.FRAMES] = Field(6, ge=2, description="the same of a static track")
    max_static_state: Annotated[float, Unit.RATIO] = Field(
        -1.0, le=0, description="log-odds of motion below which a track may be sampled as static"
    )
    cell: Annotated[int, Unit.PIXELS] = Field(
        60, ge=1, description="side of the cells of the frame that give one static track each, px"
    )
    models: tuple[Annotated[str, ChoiceOf("fused_point_models")], ...] = Field(
        ("homography", "fundamental"), min_length=1, description="point models, separated by commas"
    )
    num_hypotheses: Annotated[int, Unit.COUNT] = Field(
        100, ge=1, description="minimal samples of each model in each pair of frames"
    )
    kernel: KernelParams = KernelParams()
    clustering: TrackClusteringParams = TrackClusteringParams()

    _split_models = field_validator("models", mode="before")(split_commas)
    _check_models = field_validator("models")(check_models)


class RegroupParams(Frozen):
    """Candidates cut and joined by motion group."""

    static_majority: Annotated[float, Unit.SHARE] = Field(
        0.5, ge=0, le=1, description="share of static tracks in the sample of a group above which it is static"
    )
    static_share: Annotated[float, Unit.SHARE] = Field(
        0.35, ge=0, le=1, description="share of all static tracks of the sample above which a group is static"
    )
    keep_whole: Annotated[float, Unit.SHARE] = Field(
        0.6, ge=0, le=1, description="share of a candidate in static groups from which it is kept as it is"
    )
    spread_rounds: Annotated[int, Unit.COUNT] = Field(
        15, ge=0, description="rounds in which groups spread from sampled tracks to their neighbours"
    )
    spread_hold: Annotated[float, Unit.SHARE] = Field(
        0.7, ge=0, le=1, description="weight of a sampled track's own group in each round"
    )
    min_part: Annotated[int, Unit.COUNT] = Field(3, ge=1, description="smallest number of tracks of a part")
    near: Annotated[float, Unit.PIXELS] = Field(
        60.0, ge=0, description="distance in a frame below which parts of one group are joined, px"
    )
    max_gap: Annotated[int, Unit.FRAMES] = Field(
        5, ge=0, description="frames between the end of one part and the start of another that may go on from it"
    )
    margin: Annotated[float, Unit.PIXELS] = Field(
        6.0, ge=0, description="margin around the place at which it is expected, px"
    )
    margin_per_frame: Annotated[float, Unit.PIXELS_PER_FRAME] = Field(
        3.0, ge=0, description="growth of that margin with the frames between, px/frame"
    )
    thin_join: Annotated[float, Unit.SHARE] = Field(
        0.01,
        ge=0,
        le=1,
        description="conductance of a cut through joined tracks below which their group may be cut there: the"
        " similarity that is cut, as a share of that of the side with less of it",
    )
    min_side: Annotated[float, Unit.SHARE] = Field(
        0.1, ge=0, le=0.5, description="share of a group's similarity that a side of such a cut has at least"
    )
    min_difference: Annotated[float, Unit.SHARE] = Field(
        0.3,
        ge=0,
        le=1,
        description="smallest difference of the motion groups of both sides in one of the samples: share of a side that"
        " has other ones than the other side",
    )


class OwnVehicleParams(Frozen):
    """The vehicle that carries the camera, as far as the picture shows it, such as a bonnet."""

    min_width: Annotated[float, Unit.SHARE] = Field(
        0.5,
        gt=0,
        description="smallest width of what rides along at the lower edge, as a share of 32 columns of the picture that"
        " have a track of it: narrower things may be objects; above 1: the vehicle is not looked for",
    )
    height: Annotated[float, Unit.SHARE] = Field(
        0.33, gt=0, le=1, description="part of the picture, from the lower edge, in which the vehicle lies"
    )
    max_motion: Annotated[float, Unit.SHARE] = Field(
        0.1,
        ge=0,
        description="largest motion of the vehicle in the picture, as a share of the upper quartile of the motions"
        " around it there",
    )


class TrackObjectParams(Frozen):
    """Evidence that an object must have to be a moving one. It is absolute: in a static scene there is none."""

    min_tracks: Annotated[int, Unit.COUNT] = Field(5, ge=1, description="smallest number of tracks of an object")
    min_observations: Annotated[int, Unit.COUNT] = Field(
        20, ge=1, description="smallest number of observations of an object, summed over its tracks and frames"
    )
    max_error: Annotated[float, Unit.RATIO] = Field(
        12.0,
        gt=0,
        description="median error in a frame pair, in tolerances, beyond which it adds nothing to the score; the patch"
        " test limits errors to 5.5 by default, the square root of rigidity.test_gain times rigidity.test_limit",
    )
    min_score: Annotated[float, Unit.RATIO] = Field(
        3.0,
        ge=0,
        description="smallest score of a moving object: its summed errors times its mean strict test, per frame, of"
        " 1.7 pairs; lower finds more, and more that does not move",
    )
    min_part: Annotated[float, Unit.SHARE] = Field(
        0.7,
        ge=0,
        description="smallest score of its part in the best candidate, as a share of what such a part needs alone,"
        " scattered or not",
    )
    min_test: Annotated[float, Unit.RATIO] = Field(
        0.15,
        ge=-1,
        le=3,
        description="smallest mean strict test of a moving object: how much worse the best rigid position explains"
        " its patches than the tracked one",
    )
    min_static_test: Annotated[float, Unit.RATIO] = Field(
        0.5,
        ge=-1,
        le=3,
        description="smallest mean strict test of a part that was cut from a candidate because it seems to move as the"
        " background does",
    )
    min_enclosed: Annotated[float, Unit.SHARE] = Field(
        0.7,
        ge=0,
        le=1,
        description="smallest share of such a part's own tracks among those inside its convex hull: a body fills its"
        " place",
    )
    min_ratio: Annotated[float, Unit.SHARE] = Field(
        0.02,
        ge=0,
        le=1,
        description="smallest score of a moving object, as a share of the best object's: beside strong evidence, weak"
        " evidence is rather a slip of the tracker",
    )
    sensitivity: Annotated[float, Unit.RATIO] = Field(
        1.0,
        gt=0,
        description="divisor of the smallest scores, test and ratio: a larger one finds more movers, and more that"
        " does not move",
    )
    min_surface: Annotated[float, Unit.SHARE] = Field(
        0.25,
        gt=0,
        description="share of a surface's tracks in one object from which on the others belong to it too; above 1 none"
        " do, and every object is scattered",
    )
    min_on_surface: Annotated[float, Unit.SHARE] = Field(
        0.3,
        ge=0,
        description="share of an object's tracks on such surfaces, below which it is scattered; 0: none is",
    )
    min_scattered_score: Annotated[float, Unit.RATIO] = Field(
        12.0,
        ge=0,
        description="smallest score of a scattered object, if larger than that of any: slips of the tracker lie on no"
        " surface",
    )
    regroup: RegroupParams = RegroupParams()
    own_vehicle: OwnVehicleParams = OwnVehicleParams()
