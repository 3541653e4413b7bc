"""Parameters of motion segmentation from labelled trajectories alone: hypotheses, kernels and their clustering."""

from typing import Annotated, Literal

from pydantic import Field, PositiveInt, field_validator

from moseg.schemas.frozen import Frozen
from moseg.schemas.parameters.clustering import MotionCountParams
from moseg.schemas.units import Unit


class HypothesisParams(Frozen):
    """How hypotheses of a point model are drawn from the trajectories of a clip."""

    seed: Annotated[int, Unit.SEED] = Field(0, ge=0, description="chooses the random draws; nothing else depends on it")
    num_hypotheses: Annotated[int, Unit.COUNT] = Field(
        200, ge=1, description="minimal samples of a draw in each pair (or triple) of frames"
    )
    num_draws: Annotated[int, Unit.COUNT] = Field(
        2, ge=1, description="independent draws, each with kernels of its own: groupings of all of them compete"
    )
    gaps: Annotated[tuple[PositiveInt, ...], Unit.FRAMES] = Field(
        (1,), description="frames between neighbouring frames of a pair or triple, each used"
    )

    @field_validator("gaps", mode="before")
    @classmethod
    def _split_gaps(cls, value: object) -> object:
        return tuple(gap.strip() for gap in value.split(",")) if isinstance(value, str) else value

    @field_validator("gaps")
    @classmethod
    def _check_gaps(cls, value: tuple[int, ...]) -> tuple[int, ...]:
        if not value or min(value) < 1 or len(set(value)) < len(value):
            raise ValueError("different numbers of frames from 1 on, separated by commas")
        return value


class KernelParams(Frozen):
    """How residuals become an affinity between trajectories: the ordered residual kernel, sparsified."""

    window: Annotated[float, Unit.SHARE] = Field(
        0.1, gt=0, le=1, description="share of a pair's hypotheses that a trajectory prefers"
    )
    sparsity: Annotated[float, Unit.RATIO] = Field(
        10.0,
        ge=0,
        description="power of the affinities before a row's neighbours are chosen by their information; 0 keeps all",
    )


class PieceParams(Frozen):
    """How trajectories are cut into more pieces than there are motions, and what makes two pieces alike."""

    counts: Annotated[tuple[PositiveInt, ...], Unit.COUNT] = Field(
        (6, 8, 10), description="numbers of pieces, each tried"
    )
    window: Annotated[float, Unit.SHARE] = Field(
        0.05, gt=0, le=1, description="share of a pair's hypotheses that a piece prefers"
    )
    power: Annotated[float, Unit.RATIO] = Field(
        3.0, gt=0, description="power of the cosine between two pieces' preferences"
    )
    num_tracks: Annotated[int, Unit.COUNT] = Field(
        12, ge=1, description="most trajectories of a piece whose median residual stands for it"
    )
    num_tried: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="pairs of groups that are tried at each step of merging by energy"
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        3, ge=1, description="trajectories of a piece seen in a pair below which it takes no part"
    )

    @field_validator("counts", mode="before")
    @classmethod
    def _split_counts(cls, value: object) -> object:
        return tuple(count.strip() for count in value.split(",")) if isinstance(value, str) else value

    @field_validator("counts")
    @classmethod
    def _check_counts(cls, value: tuple[int, ...]) -> tuple[int, ...]:
        if not value or min(value) < 1 or len(set(value)) < len(value):
            raise ValueError("different numbers of pieces from 1 on, separated by commas")
        return tuple(sorted(value))


class EnergyParams(Frozen):
    """What groupings of trajectories compete by: a fundamental matrix a group and pair of frames, and the cut."""

    gap: Annotated[int, Unit.FRAMES] = Field(3, ge=1, description="frames between the two frames of a pair")
    step: Annotated[int, Unit.COUNT] = Field(2, ge=1, description="every so many pairs are looked at")
    threshold: Annotated[float, Unit.PIXELS] = Field(
        0.5, gt=0, description="tau: Sampson distance from which an observation costs 1, px"
    )
    relative: Annotated[float, Unit.SHARE] = Field(
        0.01, ge=0, description="share of a trajectory's displacement that is added to tau, in squares"
    )
    num_fits: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="rounds of reweighted least squares for each fundamental matrix"
    )
    least_unit: Annotated[float, Unit.RATIO] = Field(
        0.15, gt=0, le=1, description="costs are divided by that of a single motion, or by this where it is less"
    )
    cut_weight: Annotated[float, Unit.RATIO] = Field(
        0.85, ge=0, description="weight of the normalised cut beside the cost so divided"
    )
    motion_weight: Annotated[float, Unit.RATIO] = Field(
        0.01, ge=0, description="energy of each motion, where their number is found"
    )


class SeparationParams(Frozen):
    """Which parts of a group lie apart in the image."""

    num_neighbours: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, description="nearest trajectories that a trajectory touches"
    )
    min_tracks: Annotated[int, Unit.COUNT] = Field(
        8, ge=1, description="trajectories below which a part is no motion of its own"
    )


class TrajectoryClusteringParams(Frozen):
    """How the kernels of one or several models become motions; their number is ``clustering.motions``."""

    method: Literal["energy", "sum", "product", "coregularised"] = Field(
        "energy",
        description="the grouping of least energy among many (energy), or spectral clustering of the views' mean kernel"
        " (sum), of their geometric mean (product) or of co-regularised views (coregularised), as published; a single"
        " view is always clustered so",
    )
    auto: Literal["energy", "description_length", "geometric", "confidences", "stability", "eigengap"] = Field(
        "energy",
        description="how the number of motions is found where it is not given: least energy, the methods of"
        " clustering.auto on the best groupings, or the largest gap of the mean kernel's spectrum",
    )
    count: MotionCountParams = MotionCountParams()
    co_regularisation: Annotated[float, Unit.RATIO] = Field(0.01, ge=0, description="lambda of Kumar et al. 2011")
    num_iterations: Annotated[int, Unit.COUNT] = Field(10, ge=1, description="most alternating updates of all views")
    tolerance: Annotated[float, Unit.RATIO] = Field(
        1e-6, ge=0, description="relative growth of the objective at which the updates stop"
    )
    most_motions: Annotated[int, Unit.COUNT] = Field(
        6, ge=1, le=19, description="largest number of motions that auto may find"
    )
    num_starts: Annotated[int, Unit.COUNT] = Field(3, ge=1, description="k-means runs, of which the tightest counts")
    separate: bool = Field(
        True, description="objects that do not touch are motions of their own, where the number is found"
    )
    pieces: PieceParams = PieceParams()
    energy: EnergyParams = EnergyParams()
    separation: SeparationParams = SeparationParams()
