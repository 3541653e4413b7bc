"""Parameters of motion segmentation from trajectories only: hypotheses, kernels and their clustering."""

from typing import Annotated, Literal

from pydantic import Field, PositiveInt, field_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.schemas.parameters.comma_separated import are_different_counts, check_gaps, split_commas
from moseg.schemas.units import Unit


class HypothesisParams(Frozen):
    """Drawing of hypotheses of a point model from the trajectories of a clip."""

    seed: Annotated[int, Unit.SEED] = Field(0, ge=0, description="seed of the random draws; nothing else depends on it")
    num_hypotheses: Annotated[int, Unit.COUNT] = Field(
        200, ge=1, description="minimal samples of a draw in each pair (or triple) of frames"
    )
    num_draws: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, description="independent draws, each with its own kernels; the groupings of all draws are compared"
    )
    gaps: Annotated[tuple[PositiveInt, ...], Unit.FRAMES] = Field(
        (3,),
        description="frames between neighbouring frames of a pair or triple; all gaps are used, smaller ones in clips"
        " too short for any",
    )

    max_sets: Annotated[int, Unit.COUNT] = Field(
        20,
        ge=1,
        description="pairs (or triples) of frames in which a trajectory takes part on average; if there are more, they"
        " are spaced out evenly",
    )

    _split_gaps = field_validator("gaps", mode="before")(split_commas)
    _check_gaps = field_validator("gaps")(check_gaps)


class KernelParams(Frozen):
    """Affinity between trajectories from residuals: the ordered residual kernel, sparsified."""

    window: Annotated[float, Unit.SHARE] = Field(
        0.1, gt=0, le=1, description="share of a pair's hypotheses that a trajectory prefers"
    )
    sparsity: Annotated[float, Unit.RATIO] = Field(
        10.0,
        ge=0,
        description="power of the affinities before a row's neighbours are selected by information; 0 keeps all",
    )
    max_tracks: Annotated[int, Unit.COUNT] = Field(
        3000,
        ge=1,
        description="number of trajectories above which this many landmarks are clustered, and the others are assigned"
        " to their groups; no effect on samples of dense tracks",
    )


class NoiseReductionParams(Frozen):
    """Reduction of the noise of trajectories before anything is computed from them."""

    min_noise: Annotated[float, Unit.PIXELS] = Field(
        0.2, ge=0, description="noise of a coordinate below which the points of a window stay as they are, px"
    )
    min_frames: Annotated[int, Unit.FRAMES] = Field(
        10, ge=5, description="smallest length of a window; fewer frames do not show noise beside motion"
    )
    max_frames: Annotated[int, Unit.FRAMES] = Field(50, ge=5, description="largest length of a window")
    window_share: Annotated[float, Unit.SHARE] = Field(
        0.85,
        gt=0,
        le=1,
        description="length of a window relative to the median trajectory; where this share of a complete one is a"
        " whole number of frames, the window is the clip",
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        20, ge=1, description="trajectories seen throughout a window, below which it is left as it is"
    )
    min_visible: Annotated[int, Unit.FRAMES] = Field(
        5, ge=1, description="frames of a window in which a trajectory is seen, below which it is left as it is"
    )
    min_stray: Annotated[float, Unit.PIXELS] = Field(
        0.5,
        ge=0,
        description="distance from the directions of all motions up to which a trajectory is no stray, px, even if the"
        " usual distance is less than a tenth of it; strays give no hypotheses and join a group after the others",
    )
    num_rounds: Annotated[int, Unit.COUNT] = Field(
        5, ge=1, description="largest number of rounds in which trajectories far from all others are left out"
    )


class ClipSectionParams(Frozen):
    """Sections of a clip that is much longer than its trajectories; each is grouped, and the groups are linked."""

    max_length: Annotated[float, Unit.RATIO] = Field(
        4.0, ge=1, description="length of a clip that is grouped in one part, relative to the median trajectory"
    )
    length: Annotated[float, Unit.RATIO] = Field(
        3.0, ge=1, description="length of a section, relative to the median trajectory; sections overlap by half"
    )
    min_frames: Annotated[int, Unit.FRAMES] = Field(20, ge=4, description="smallest length of a section")
    min_visible: Annotated[int, Unit.FRAMES] = Field(
        5, ge=2, description="frames of a section in which a trajectory is seen, below which it is not grouped there"
    )


class PieceParams(Frozen):
    """Over-segmentation of trajectories into pieces, and the affinity of pieces."""

    counts: Annotated[tuple[PositiveInt, ...], Unit.COUNT] = Field(
        (6, 10), description="numbers of pieces; all are tried"
    )
    window: Annotated[float, Unit.SHARE] = Field(
        0.05, gt=0, le=1, description="share of a pair's hypotheses that a piece prefers"
    )
    power: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="power of the cosine between two pieces' preferences"
    )
    num_tracks: Annotated[int, Unit.COUNT] = Field(
        12, ge=1, description="maximal number of trajectories of a piece for its median residual"
    )
    merged: Literal["middle", "finest"] = Field(
        "finest",
        description="pieces that are merged by energy: of the middle number, from all views, or of the largest number,"
        " from all views but the least general",
    )
    num_tried: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="pairs of groups tried at each step of merging by energy"
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, description="visible trajectories of a piece below which it is ignored in a pair"
    )

    _split_counts = field_validator("counts", mode="before")(split_commas)

    @field_validator("counts")
    @classmethod
    def _check_counts(cls, value: tuple[int, ...]) -> tuple[int, ...]:
        if not are_different_counts(value):
            raise ValueError("different numbers of pieces from 1 on, separated by commas")
        return tuple(sorted(value))


class CodingParams(Frozen):
    """Coding length of the trajectories of a group over many frames."""

    noise: Annotated[float, Unit.PIXELS] = Field(
        1.0, gt=0, description="precision to which coordinates are described, px"
    )
    num_frames: Annotated[int, Unit.FRAMES] = Field(
        8, ge=3, le=64, description="frames of a window that are read, evenly spaced"
    )
    window_share: Annotated[float, Unit.SHARE] = Field(
        0.85,
        gt=0,
        le=1,
        description="length of a window relative to the median trajectory, unless that is as long as the clip",
    )
    min_frames: Annotated[int, Unit.FRAMES] = Field(5, ge=3, description="smallest length of a window")
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        10, ge=1, description="trajectories that span a window, below which it is ignored"
    )
    num_rounds: Annotated[int, Unit.COUNT] = Field(
        10, ge=0, description="rounds in which projective depths are estimated; 0 codes for an affine camera"
    )


class EnergyParams(Frozen):
    """Energy of groupings: fundamental matrices of groups, the cut, and the coding length over many frames."""

    gaps: Annotated[tuple[PositiveInt, ...], Unit.FRAMES] = Field(
        (3, 8),
        description="frames between the two frames of a pair; all gaps are used, and the largest possible in place of"
        " those too long for a clip",
    )
    spacing: Annotated[float, Unit.RATIO] = Field(
        0.5, gt=0, description="frames between the starts of the pairs of a gap that are read, relative to the gap"
    )
    min_spanning: Annotated[float, Unit.SHARE] = Field(
        0.8,
        ge=0,
        le=1,
        description="share of the trajectories in the first frames of a gap's pairs that must be seen in the second"
        " frames too; else the gap is left out, unless it is the smallest",
    )
    max_pairs: Annotated[int, Unit.COUNT] = Field(
        60,
        ge=1,
        description="pairs of a gap in which a trajectory takes part on average; if there are more, they are spaced out"
        " evenly",
    )
    threshold: Annotated[float, Unit.PIXELS] = Field(
        0.5, gt=0, description="tau: Sampson distance at which the cost of an observation reaches 1, px"
    )
    relative: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, description="share of a trajectory's displacement that is added to tau, in squares"
    )
    num_fits: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="rounds of reweighted least squares for each fundamental matrix"
    )
    least_unit: Annotated[float, Unit.RATIO] = Field(
        0.2, gt=0, le=1, description="lower bound of the cost of a single motion, by which costs are divided"
    )
    cut_weight: Annotated[float, Unit.RATIO] = Field(
        1.2, ge=0, description="weight of the normalised cut relative to the divided cost"
    )
    coding_weight: Annotated[float, Unit.RATIO] = Field(
        2.5, ge=0, description="weight of the coding length relative to the divided cost; 0 leaves it out"
    )
    motion_weight: Annotated[float, Unit.RATIO] = Field(
        0.0, ge=0, description="penalty on each motion beyond free_motions if the number is found"
    )
    chance_weight: Annotated[float, Unit.RATIO] = Field(
        1.2,
        ge=0,
        description="addition to motion_weight, divided by the square root of the number of trajectories: the fewer,"
        " the more a split of one motion saves by chance",
    )
    free_motions: Annotated[int, Unit.COUNT] = Field(
        2, ge=0, description="motions without penalty: a clip is expected to show something that moves"
    )
    coding: CodingParams = CodingParams()

    _split_gaps = field_validator("gaps", mode="before")(split_commas)
    _check_gaps = field_validator("gaps")(check_gaps)


class SeparationParams(Frozen):
    """Connected parts of a group in the image."""

    num_neighbours: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="number of nearest trajectories to which a trajectory is connected"
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="trajectories below which a part is not a separate motion"
    )
    min_gap: Annotated[float, Unit.RATIO] = Field(
        1.0,
        ge=0,
        description="distance of a part from the others, relative to the diagonal of the smaller, below which it is not"
        " a separate motion",
    )


class OutlierParams(Frozen):
    """Trajectories that follow no motion, which join a group after the clustering; no effect on dense tracks."""

    num_neighbours: Annotated[int, Unit.COUNT] = Field(
        5, ge=1, description="number of trajectories of largest affinity whose mean affinity is compared"
    )
    min_affinity: Annotated[float, Unit.SHARE] = Field(
        0.4,
        ge=0,
        le=1,
        description="share of the upper quartile of this mean over all trajectories, below which one is an outlier; the"
        " mean of one far from all hypotheses is reduced before; 0 keeps all",
    )
    affinity_floor: Annotated[float, Unit.SHARE] = Field(
        0.1,
        ge=0,
        le=1,
        description="share of the same quartile that is added to the affinity between an outlier and a group before it"
        " is divided by the root of their distance over all frames",
    )


class TrajectoryClusteringParams(Frozen):
    """Clustering of trajectories by the kernels of one or several models; ``clustering.motions`` is the number."""

    method: Literal["energy", "sum", "product", "coregularised"] = Field(
        "energy",
        description="the grouping of minimal energy among many (energy), or spectral clustering, as published, of the"
        " views' mean kernel (sum), of their geometric mean (product) or of co-regularised views (coregularised); a"
        " single view is always clustered spectrally",
    )
    auto: Literal["energy", "description_length", "geometric", "confidences", "stability", "eigengap"] = Field(
        "energy",
        description="method for the number of motions if it is not given: minimal energy, the methods of"
        " clustering.auto on the best groupings, or the largest gap of the mean kernel's spectrum",
    )
    count: MotionCountParams = MotionCountParams()
    co_regularisation: Annotated[float, Unit.RATIO] = Field(0.01, ge=0, description="lambda of Kumar et al. 2011")
    num_iterations: Annotated[int, Unit.COUNT] = Field(
        10, ge=1, description="maximal number of alternating updates of all views"
    )
    tolerance: Annotated[float, Unit.RATIO] = Field(
        1e-6, ge=0, description="relative growth of the objective at which the updates stop"
    )
    most_motions: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, le=19, description="largest number of motions that auto may find"
    )
    num_starts: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, description="k-means runs, of which the one of smallest inertia is used"
    )
    trust_agreement: bool = Field(
        True,
        description="only one grouping is refined, without merging and splits, if it has the lowest energy in every"
        " draw of hypotheses and needs fewer bits than a single motion",
    )
    num_refined: Annotated[int, Unit.COUNT] = Field(
        4, ge=0, description="groupings of lowest energy that are refined; 0 leaves the best as it is"
    )
    num_refinements: Annotated[int, Unit.COUNT] = Field(
        8,
        ge=1,
        description="largest number of moves of pieces, and of rounds of moves of trajectories, of a refinement",
    )
    num_split: Annotated[int, Unit.COUNT] = Field(
        2,
        ge=0,
        description="groupings refined that split a small piece off the best grouping into one motion less; 0 splits"
        " none",
    )
    small_pieces: Annotated[int, Unit.COUNT] = Field(20, ge=1, description="number of small pieces")
    num_more: Annotated[int, Unit.COUNT] = Field(
        2,
        ge=0,
        description="if the number is given, draws of hypotheses differ and the best grouping needs fewer bits than a"
        " single motion: numbers beyond it that are searched too, so that two of their groups can be merged; 0 searches"
        " none; no effect on samples of dense tracks, whose number is found",
    )
    count_margin: Annotated[float, Unit.RATIO] = Field(
        0.15,
        ge=0,
        description="if the number is found: energy above the lowest of any number up to which a number is searched",
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        9,
        ge=1,
        description="trajectories of the smallest motion, below which a grouping into more than energy.free_motions is"
        " not found; any eight have a fundamental matrix",
    )
    separate: bool = Field(
        True,
        description="unconnected objects are separate motions if the number is found, and count against a grouping if"
        " it is given",
    )
    pieces: PieceParams = PieceParams()
    energy: EnergyParams = EnergyParams()
    separation: SeparationParams = SeparationParams()
    outliers: OutlierParams = OutlierParams()
