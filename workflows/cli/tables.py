"""Tables on the terminal."""

from rich.console import Console
from rich.table import Table

from moseg.schemas.scores import EvaluationReport, GroundTruth, SequenceScore
from moseg.workflows.engine.session import StageUse
from moseg.workflows.reports.published_scores import PAPER_COLUMNS, PAPER_ROWS
from moseg.workflows.reports.score_tables import score_columns


def console() -> Console:
    """Standard output; wide enough for every column where it is not a terminal."""
    plain = Console()
    return plain if plain.is_terminal else Console(width=140)


def print_report(report: EvaluationReport, notes: tuple[str, ...] = ()) -> None:
    """Scores per sequence and mean for every variant, and the paper's rows where it has the data set."""
    out = console()
    for note in notes:
        out.print(f"note: {note}", highlight=False)
    for row in report.rows:
        table = _score_table(f"{report.dataset}, {row.variant}", "sequence", report.over)
        for name, score in row.sequences.items():
            table.add_row(name, *_cells(score, report.over))
        table.add_section()
        table.add_row("mean", *_cells(row.mean, report.over))
        out.print(table)
    print_paper(out, report.dataset, report.over)
    out.print(
        f"{report.store.computed} artifacts computed, {report.store.reused} reused, {report.seconds:.1f} s",
        highlight=False,
    )


def print_ablation(report: EvaluationReport, notes: tuple[str, ...] = ()) -> None:
    """One row a variant: means over the sequences."""
    out = console()
    for note in notes:
        out.print(f"note: {note}", highlight=False)
    num_sequences = len(report.rows[0].sequences)
    table = _score_table(f"{report.dataset}, mean of {num_sequences} sequences", "variant", report.over)
    for row in report.rows:
        table.add_row(row.variant, *_cells(row.mean, report.over))
    out.print(table)
    print_paper(out, report.dataset, report.over)


def print_paper(out: Console, dataset: str, over: GroundTruth = "pixels") -> None:
    """The paper's figures for a data set, marked as the paper's and, beside scores over points, as over pixels."""
    rows = PAPER_ROWS.get(dataset)
    if rows is None:
        return
    kind = ", over pixels" if over == "points" else ""
    table = Table(title=f"{dataset}{kind}, as the paper reports it (not measured here)")
    table.add_column("method")
    for name in PAPER_COLUMNS:
        table.add_column(name, justify="right")
    for method, scores in rows.items():
        table.add_row(method, *(f"{value:.2f}" for value in scores))
    out.print(table)


def print_stages(stages: dict[str, StageUse]) -> None:
    """Artifacts computed and reused by stage, and the seconds inside each stage's functions."""
    table = Table(title="artifacts by stage")
    table.add_column("stage")
    for name in ("computed", "reused", "reused %", "seconds"):
        table.add_column(name, justify="right")
    for stage, use in stages.items():
        total = use.computed + use.reused
        share = f"{100 * use.reused / total:.0f}" if total else "-"
        table.add_row(stage, str(use.computed), str(use.reused), share, f"{use.seconds:.1f}" if use.seconds else "-")
    console().print(table)


def _score_table(title: str, first: str, over: GroundTruth) -> Table:
    table = Table(title=f"{title}, over points" if over == "points" else title)
    table.add_column(first)
    for name in score_columns(over):
        table.add_column(name, justify="right")
    return table


def _cells(score: SequenceScore, over: GroundTruth) -> list[str]:
    return [f"{getattr(score, name):.1f}" for name in score_columns(over).values()]
