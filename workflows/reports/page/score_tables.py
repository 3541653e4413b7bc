"""Score tables with their best values marked, and published rows below the measured rows of the same columns."""

from typing import NamedTuple

from moseg.workflows.reports.table_content import Better, ScoreTable

ONE_EACH = ("sequence", "clip")
"""Heads of the first column where rows are scenes: those do not compete."""
MOST_UNFOLDED = 12


class ScoreCell(NamedTuple):
    """A figure as text, empty where there is none, and whether none of its column is better."""

    text: str
    is_best: bool


class ScoreGroup(NamedTuple):
    """Rows that belong together: those measured, or those that a paper reports."""

    title: str
    is_published: bool
    rows: tuple[tuple[str, tuple[ScoreCell, ...]], ...]


class ScoreTableView(NamedTuple):
    """One table of the page; the title is its first group's.

    Attributes
    ----------
    columns : tuple of str
    over : 'pixels', 'points' or None
    groups : tuple of ScoreGroup
    is_folded : bool
        Whether a reader has to open it: details that would push the sequences out of sight.
    """

    columns: tuple[str, ...]
    over: str | None
    groups: tuple[ScoreGroup, ...]
    is_folded: bool = False


def _best(values: list[float | None], better: Better | None, decimals: int) -> float | None:
    """The best value as printed; None where no two differ or none is better."""
    known = [round(value, decimals) for value in values if value is not None]
    if better is None or len(known) < 2 or min(known) == max(known):
        return None
    return max(known) if better is Better.MORE else min(known)


def _group(table: ScoreTable) -> ScoreGroup:
    num_columns = len(table.columns) - 1
    better = table.better or (Better.MORE,) * num_columns
    decimals = table.decimals or (1,) * num_columns
    columns = [[values[column] for _, values in table.rows] for column in range(num_columns)]
    competes = not table.is_published and table.columns[0] not in ONE_EACH
    best = [_best(*column) if competes else None for column in zip(columns, better, decimals, strict=True)]

    def cell(value: float | None, column: int) -> ScoreCell:
        if value is None:
            return ScoreCell("", False)
        return ScoreCell(f"{value:.{decimals[column]}f}", round(value, decimals[column]) == best[column])

    rows = ((name, tuple(cell(value, column) for column, value in enumerate(values))) for name, values in table.rows)
    return ScoreGroup(table.title, table.is_published, tuple(rows))


def gather_score_tables(tables: tuple[ScoreTable, ...]) -> tuple[ScoreTableView, ...]:
    """Tables of a page: published figures lie below the measured ones that stand before them, where columns agree.

    Tables of single scenes come last, folded, where there are many rows of them.
    """
    views: list[ScoreTableView] = []
    for table in tables:
        last = views[-1] if views else None
        if table.is_published and last and (last.columns[1:], last.over) == (table.columns[1:], table.over):
            views[-1] = last._replace(groups=(*last.groups, _group(table)))
        else:
            views.append(ScoreTableView(table.columns, table.over, (_group(table),)))
    details = [view for view in views[1:] if view.columns[0] in ONE_EACH]
    if sum(len(view.groups[0].rows) for view in details) <= MOST_UNFOLDED:
        return tuple(views)
    return (*(view for view in views if view not in details), *(view._replace(is_folded=True) for view in details))
