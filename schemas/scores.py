"""Scores of one sequence and the report of an evaluation, as written to JSON."""

from typing import Literal

from pydantic import ConfigDict, Field

from moseg.schemas.frozen import Frozen

GroundTruth = Literal["pixels", "points"]
"""Elements that ground truth labels: every pixel of a frame, or points in it."""


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
    notes : tuple of str
        What must be known to read the scores rightly; no part of the JSON.
    """

    model_config = ConfigDict(populate_by_name=True)

    dataset: str
    over: GroundTruth = "pixels"
    rows: tuple[EvaluationRow, ...]
    matching: dict[str, Literal["name", "order", "number"]] | None = None
    store: StoreUse
    seconds: float = Field(ge=0)
    notes: tuple[str, ...] = Field((), exclude=True)


def mean_score(scores: list[SequenceScore]) -> SequenceScore:
    """Return the mean of each percentage over sequences; None if a sequence does not have it."""
    columns = {name: [getattr(score, name) for score in scores] for name in SequenceScore.model_fields}
    return SequenceScore(**{n: None if None in column else sum(column) / len(column) for n, column in columns.items()})
