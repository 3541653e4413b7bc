"""Scores of one sequence and the report of an evaluation, as written to JSON."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

from pydantic import ConfigDict, Field

from moseg.schemas.frozen import Frozen

GroundTruth = Literal["pixels", "points", "still"]
"""Elements that ground truth labels: every pixel of a frame, or points in it; or nothing moves at all."""
Matching = Literal["name", "order", "number"]
"""Property by which saved masks are matched to frames."""


class SequenceScore(Frozen):
    """Percentages 0..100 of one sequence.

    Attributes
    ----------
    P, R, F : float
        Pu, Ru, Fu of Dave et al. 2019.
    J : float
        Region similarity of the union of moving masks, mean over annotated frames.
    boundary_F : float
        Contour accuracy (DAVIS) of the union of moving masks, mean over annotated frames.
    J_objects, boundary_F_objects : float
        The same per ground-truth object under the Hungarian assignment, mean over objects.

    If ground truth labels points, P, R, F and J count points instead of pixels, and boundary scores are None.
    """

    P: float
    R: float
    F: float
    J: float
    boundary_F: float | None = None
    J_objects: float
    boundary_F_objects: float | None = None


class EvaluationRow(Frozen):
    """Scores of one variant: one per sequence, and their mean."""

    variant: str
    sequences: dict[str, SequenceScore]
    mean: SequenceScore


class StoreUse(Frozen):
    """Artifacts computed and reused by a run."""

    computed: int
    reused: int


class ScoredWith(Frozen):
    """Version and parameters with which a report's scores were computed.

    Attributes
    ----------
    version : str
        Of moseg.
    config : dict of str to value
        Parameters that differ from their defaults, by their full names (``affinity.method``).
    """

    version: str
    config: dict[str, Any]


class EvaluationReport(Frozen):
    """Content of the file that ``--json`` writes, without values that are None.

    Attributes
    ----------
    dataset : str
    over : 'pixels' or 'points'
        Elements that every score counts: pixels of annotated masks, or labelled points.
    rows : tuple of EvaluationRow
    matching : dict of str to 'name', 'order' or 'number', or None
        How saved masks were matched to the frames, by sequence; None if masks were computed.
    store : StoreUse
    seconds : float
    settings : ScoredWith, optional
        None for saved masks.
    notes : tuple of str
        What must be known to read the scores rightly; no part of the JSON.
    """

    model_config = ConfigDict(populate_by_name=True)

    dataset: str
    over: Literal["pixels", "points"] = "pixels"
    rows: tuple[EvaluationRow, ...]
    matching: dict[str, Matching] | None = None
    store: StoreUse
    seconds: float = Field(ge=0)
    settings: ScoredWith | None = None
    notes: tuple[str, ...] = Field((), exclude=True)


class StillScore(Frozen):
    """Percentages 0..100 of one sequence in which nothing moves.

    Attributes
    ----------
    false_pixels : float
        Pixels labelled as moving, of the pixels of all frames.
    false_frames : float
        Frames with at least one such pixel.
    """

    false_pixels: float
    false_frames: float


class StillRow(Frozen):
    """Scores of one variant where nothing moves: one per sequence, and their mean."""

    variant: str
    sequences: dict[str, StillScore]
    mean: StillScore


class StillReport(Frozen):
    """Content of the file that ``--json`` writes where nothing moves; as `EvaluationReport` otherwise."""

    dataset: str
    over: Literal["still"] = "still"
    rows: tuple[StillRow, ...]
    matching: dict[str, Matching] | None = None
    store: StoreUse
    seconds: float = Field(ge=0)
    settings: ScoredWith | None = None
    notes: tuple[str, ...] = Field((), exclude=True)


AnyScore = SequenceScore | StillScore
AnyReport = EvaluationReport | StillReport


def make_report(over: GroundTruth, scores: Mapping[str, Mapping[str, AnyScore]], **fields) -> AnyReport:
    """Return the report of the scores by variant and sequence; `fields` are its others."""
    if over == "still":
        return StillReport(rows=_make_rows(StillRow, scores), **fields)
    return EvaluationReport(over=over, rows=_make_rows(EvaluationRow, scores), **fields)


def _make_rows(kind: type, scores: Mapping[str, Mapping[str, AnyScore]]) -> tuple:
    return tuple(
        kind(variant=variant, sequences=by_name, mean=mean_score(list(by_name.values())))
        for variant, by_name in scores.items()
    )


def score_class(over: GroundTruth) -> type[AnyScore]:
    """Return the class of the scores of a kind of ground truth."""
    return StillScore if over == "still" else SequenceScore


def mean_score(scores: Sequence[AnyScore]) -> AnyScore:
    """Return the mean of each percentage over sequences, all of one class; None if a sequence does not have it."""
    kind = type(scores[0])
    columns = {name: [getattr(score, name) for score in scores] for name in kind.model_fields}
    return kind(**{name: None if None in column else sum(column) / len(column) for name, column in columns.items()})
