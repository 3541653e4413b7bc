"""Tables on the terminal."""

from typing import TYPE_CHECKING

from rich.console import Console
from rich.table import Table

from moseg.schemas.scores import AnyReport, AnyScore, EvaluationRow, GroundTruth, StillRow
from moseg.schemas.trajectory_scores import TrajectoryReport, TrajectoryRow
from moseg.workflows.reports.published_groups import PUBLISHED_GROUPS, RERUN_NOTE
from moseg.workflows.reports.published_scores import (
    ONE_MOTION_ERROR,
    PAPER_COLUMNS,
    PAPER_ROWS,
    PUBLISHED_CLIPS,
    PUBLISHED_ERRORS,
)
from moseg.workflows.reports.score_tables import score_columns, score_decimals, share_rows

if TYPE_CHECKING:
    from moseg.workflows.api.evaluation import Evaluated, Planned

Report = AnyReport | TrajectoryReport


def console() -> Console:
    """Return standard output, wide enough for every column where it is not a terminal.

    Names may have square brackets, which are no markup.
    """
    plain = Console(markup=False, emoji=False)
    return plain if plain.is_terminal else Console(width=140, markup=False, emoji=False)


def print_report(report: Report) -> None:
    """Print scores per sequence and mean for every variant, and what is published on the data set."""
    out = _open(report)
    for row in share_rows(report.rows):
        out.print(_clip_table(report, row) if isinstance(report, TrajectoryReport) else _sequence_table(report, row))
    _print_groups(out, report)
    _print_published(out, report)
    out.print(_use(report), highlight=False)


def print_ablation(report: Report) -> None:
    """Print one row a variant: means over the sequences."""
    out = _open(report)
    num_sequences = len(report.rows[0].sequences)
    if isinstance(report, TrajectoryReport):
        title, has_spread = f"{report.dataset}, {num_sequences} clips", report.rows[0].spread is not None
        table = _table(title, "variant", "mean error %", "median", "right number %", has_spread=has_spread)
        for row in share_rows(report.rows):
            figures = (row.mean.error, row.mean.median_error, row.mean.num_motions_correct)
            table.add_row(row.variant, *(f"{figure:.1f}" for figure in figures), *_spread_cell(row.spread))
    else:
        table = _score_table(f"{report.dataset}, mean of {num_sequences} sequences", "variant", report.over)
        for row in share_rows(report.rows):
            table.add_row(row.variant, *_cells(row.mean, report.over))
    out.print(table)
    _print_groups(out, report)
    _print_published(out, report)


def print_use(report: Report) -> None:
    """Print how many artifacts were computed and reused, and how long it took."""
    print(_use(report))


def print_stages(done: "Evaluated | Planned") -> None:
    """Print artifacts computed and reused by stage, and the seconds inside each stage's functions."""
    table = _table("artifacts by stage", "stage", "computed", "reused", "reused %", "seconds")
    for stage, use in done.stages.items():
        total = use.computed + use.reused
        share = f"{100 * use.reused / total:.0f}" if total else "-"
        table.add_row(stage, str(use.computed), str(use.reused), share, f"{use.seconds:.1f}" if use.seconds else "-")
    console().print(table)


def _open(report: Report) -> Console:
    """Return the console, with the notes printed."""
    out = console()
    for note in report.notes:
        out.print(f"note: {note}", highlight=False)
    return out


def _use(report: Report) -> str:
    return f"{report.store.computed} artifacts computed, {report.store.reused} reused, {report.seconds:.1f} s"


def _sequence_table(report: AnyReport, row: EvaluationRow | StillRow) -> Table:
    table = _score_table(f"{report.dataset}, {row.variant}", "sequence", report.over)
    for name, score in row.sequences.items():
        table.add_row(name, *_cells(score, report.over))
    table.add_section()
    table.add_row("mean", *_cells(row.mean, report.over))
    return table


def _clip_table(report: TrajectoryReport, row: TrajectoryRow) -> Table:
    title, has_spread = f"{report.dataset}, {row.variant}", row.spread is not None
    table = _table(title, "clip", "error %", "motions", "true", has_spread=has_spread)
    for name, score in row.sequences.items():
        motions = f"{score.num_motions:.1f}" if has_spread else str(score.num_motions)
        table.add_row(name, f"{score.error:.1f}", motions, str(score.num_motions_true), *_spread_cell(score.spread))
    table.add_section()
    right = f"{row.mean.num_motions_correct:.0f} % right"
    table.add_row("mean", f"{row.mean.error:.1f}", right, "", *_spread_cell(row.spread))
    table.add_row("median", f"{row.mean.median_error:.1f}")
    return table


def _print_groups(out: Console, report: Report) -> None:
    """Print mean and median error of each group of clips, where the data set has groups.

    A single variant has its share of clips with the right number of motions too.
    """
    if not isinstance(report, TrajectoryReport) or report.rows[0].groups is None:
        return
    title = f"{report.dataset}, mean / median error % by group"
    is_single = len(report.rows) == 1
    heads = (*(row.variant for row in report.rows), *(("right number %",) if is_single else ()))
    table = _table(title, "group", "clips", *heads)
    for name, group in report.rows[0].groups.items():
        errors = [(row.groups[name].error, row.groups[name].median_error) for row in report.rows]
        right = (f"{group.num_motions_correct:.0f}",) if is_single else ()
        table.add_row(name, f"{group.num_sequences} of {group.num_published}", *map(_format_error, errors), *right)
    out.print(table)


def _format_error(error: tuple[float, float | None] | None) -> str:
    """Return mean and median as text; an empty one where nothing is reported."""
    if error is None:
        return ""
    mean, median = error
    return f"{mean:.2f}" if median is None else f"{mean:.2f} / {median:.2f}"


def _print_published(out: Console, report: Report) -> None:
    """Print what is published on a data set, marked as not measured here; beside scores over points, as over pixels."""
    if report.dataset in PUBLISHED_GROUPS:
        published = PUBLISHED_GROUPS[report.dataset]
        title = "as published for all clips of a group, number of motions given (not measured here)"
        table = _table(title, "mean / median error %", *published.methods)
        for name, errors in published.rows.items():
            table.add_row(name, *map(_format_error, errors))
        table.caption = RERUN_NOTE
        out.print(table)
    elif report.dataset == "kt3dmoseg":
        title = f"as published for all {PUBLISHED_CLIPS} clips, number of motions given (not measured here)"
        table = _table(title, "Xu, Cheong, Li, CVPR 2018", "error %")
        for method, (low, high) in PUBLISHED_ERRORS.items():
            table.add_row(method, f"{low:g}" if low == high else f"{low:g} to {high:g}")
        table.add_section()
        table.add_row("everything one motion", f"{ONE_MOTION_ERROR:.1f}")
        out.print(table)
    elif report.dataset in PAPER_ROWS:
        kind = ", over pixels" if report.over == "points" else ""
        title = f"{report.dataset}{kind}, as the paper reports it (not measured here)"
        table = _table(title, "method", *PAPER_COLUMNS)
        for method, scores in PAPER_ROWS[report.dataset].items():
            table.add_row(method, *(f"{value:.2f}" for value in scores))
        out.print(table)


def _table(title: str, first: str, *others: str, has_spread: bool = False) -> Table:
    table = Table(title=title)
    table.add_column(first)
    for name in (*others, "spread of error") if has_spread else others:
        table.add_column(name, justify="right")
    return table


def _score_table(title: str, first: str, over: GroundTruth) -> Table:
    return _table(f"{title}, over points" if over == "points" else title, first, *score_columns(over))


def _cells(score: AnyScore, over: GroundTruth) -> list[str]:
    return [f"{getattr(score, name):.{score_decimals(over)}f}" for name in score_columns(over).values()]


def _spread_cell(spread: float | None) -> list[str]:
    """Return the last cell of a row; none where seeds were not asked for."""
    return [] if spread is None else [f"{spread:.1f}"]
