"""A report put together: facts, tables and panels of one run."""

from collections.abc import Iterable, Sequence

from moseg.schemas.configs import PipelineConfig, TrajectoryVariant, Variant
from moseg.schemas.scores import EvaluationReport
from moseg.workflows.reports.content import ReportPage, SequencePanel
from moseg.workflows.reports.facts import RunFacts
from moseg.workflows.reports.panels import MOST_SEQUENCES
from moseg.workflows.reports.parameter_rows import parameter_rows
from moseg.workflows.reports.score_tables import score_tables
from moseg.workflows.reports.table_content import ScoreTable


def build_page(
    about: str,
    variants: Sequence[Variant | TrajectoryVariant],
    config: PipelineConfig,
    facts: RunFacts,
    notes: Iterable[str],
    scores: tuple[ScoreTable, ...],
    panels: Iterable[SequencePanel],
) -> ReportPage:
    """The page of a run about a data set or a video."""
    return ReportPage(
        title=f"{about}: {', '.join(variant.value for variant in variants)}",
        facts=facts.rows,
        notes=tuple(notes),
        scores=scores,
        sequences=tuple(panels),
        stages=facts.stages,
        parameters=parameter_rows(config),
    )


def tables_of(report: EvaluationReport) -> tuple[ScoreTable, ...]:
    """The tables of what an evaluation returned."""
    return score_tables(report.dataset, report.over, {row.variant: row.sequences for row in report.rows})


def panel_notes(num_sequences: int, num_shown: int, seeds: Sequence[int] | None = None) -> tuple[str, ...]:
    """What a reader must know of the pictures: how many sequences have some, and under which seed."""
    notes = []
    if num_shown < num_sequences:
        notes.append(
            f"pictures of the first {MOST_SEQUENCES} of {num_sequences} sequences: `moseg report RUN --sequences a,b`"
            " shows others; the tables have all"
        )
    if seeds is not None:
        notes.append(f"pictures and matrices are those of seed {seeds[0]}")
    return tuple(notes)
