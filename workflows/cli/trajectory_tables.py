"""Tables of evaluations on labelled trajectories."""

from rich.console import Console
from rich.table import Table

from moseg.schemas.trajectory_scores import TrajectoryReport, TrajectoryRow
from moseg.workflows.cli.tables import console
from moseg.workflows.reports.published_scores import ONE_MOTION_ERROR, PUBLISHED_CLIPS, PUBLISHED_ERRORS


def print_trajectory_report(report: TrajectoryReport, notes: tuple[str, ...] = ()) -> None:
    """Errors and numbers of motions per clip for every variant, and what is published below."""
    out = _open(notes)
    for row in report.rows:
        out.print(_clip_table(report.dataset, row))
    _print_published(out)
    out.print(
        f"{report.store.computed} artifacts computed, {report.store.reused} reused, {report.seconds:.1f} s",
        highlight=False,
    )


def print_trajectory_ablation(report: TrajectoryReport, notes: tuple[str, ...] = ()) -> None:
    """One row a variant: means over the clips."""
    out = _open(notes)
    title, has_spread = f"{report.dataset}, {len(report.rows[0].sequences)} clips", report.rows[0].spread is not None
    table = _table(title, "variant", "mean error %", "median", "right number %", has_spread=has_spread)
    for row in report.rows:
        figures = (row.mean.error, row.mean.median_error, row.mean.num_motions_correct)
        table.add_row(row.variant, *(f"{figure:.1f}" for figure in figures), *_cell(row.spread))
    out.print(table)
    _print_published(out)


def _open(notes: tuple[str, ...]) -> Console:
    out = console()
    for note in notes:
        out.print(f"note: {note}", highlight=False)
    return out


def _clip_table(dataset: str, row: TrajectoryRow) -> Table:
    table = _table(f"{dataset}, {row.variant}", "clip", "error %", "motions", "true", has_spread=row.spread is not None)
    for name, score in row.sequences.items():
        motions = str(score.num_motions) if row.spread is None else f"{score.num_motions:.1f}"
        table.add_row(name, f"{score.error:.1f}", motions, str(score.num_motions_true), *_cell(score.spread))
    table.add_section()
    table.add_row(
        "mean", f"{row.mean.error:.1f}", f"{row.mean.num_motions_correct:.0f} % right", "", *_cell(row.spread)
    )
    table.add_row("median", f"{row.mean.median_error:.1f}")
    return table


def _table(title: str, first: str, *others: str, has_spread: bool = False) -> Table:
    table = Table(title=title)
    table.add_column(first)
    for name in (*others, "spread of error") if has_spread else others:
        table.add_column(name, justify="right")
    return table


def _cell(spread: float | None) -> list[str]:
    """The last cell of a row; none where seeds were not asked for."""
    return [] if spread is None else [f"{spread:.1f}"]


def _print_published(out: Console) -> None:
    title = f"as published for all {PUBLISHED_CLIPS} clips, number of motions given (not measured here)"
    table = _table(title, "Xu, Cheong, Li, CVPR 2018", "error %")
    for method, (least, most) in PUBLISHED_ERRORS.items():
        table.add_row(method, f"{least:g}" if least == most else f"{least:g} to {most:g}")
    table.add_section()
    table.add_row("everything one motion", f"{ONE_MOTION_ERROR:.1f}")
    out.print(table)
