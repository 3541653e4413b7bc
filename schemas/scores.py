"""Scores of one sequence and the report of an evaluation, as written to JSON."""

from pydantic import ConfigDict, Field

from schemas.frozen import Frozen


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
    """

    P: float
    R: float
    F: float
    J: float
    boundary_F: float
    J_objects: float
    boundary_F_objects: float


class EvaluationRow(Frozen):
    """One variant: a score per sequence, and their mean."""

    variant: str
    sequences: dict[str, SequenceScore]
    mean: SequenceScore


class StoreUse(Frozen):
    """Artifacts computed and reused by a run."""

    computed: int
    reused: int


class EvaluationReport(Frozen):
    """What ``--json`` writes."""

    model_config = ConfigDict(populate_by_name=True)

    dataset: str
    rows: tuple[EvaluationRow, ...]
    store: StoreUse
    seconds: float = Field(ge=0)


def mean_score(scores: list[SequenceScore]) -> SequenceScore:
    """Mean of each percentage over sequences."""
    fields = SequenceScore.model_fields
    return SequenceScore(**{name: sum(getattr(s, name) for s in scores) / len(scores) for name in fields})
