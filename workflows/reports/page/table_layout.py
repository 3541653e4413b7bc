"""Layout of score tables: best values marked, published rows below the measured rows of the same columns."""

from typing import NamedTuple

from moseg.workflows.reports.content import Better, ScoreTable

SCENES = ("sequence", "clip")
"""Heads of the first column where rows are scenes: their values are not compared."""
MAX_UNFOLDED = 12
"""Rows of single scenes that a page shows unfolded."""


class ScoreCell(NamedTuple):
    """A figure as text, empty where there is none, and whether none of its column is better."""

    text: str
    is_best: bool


class RowGroup(NamedTuple):
    """Rows of one table: either measured, or reported by a paper."""

    title: str
    is_published: bool
    rows: tuple[tuple[str, tuple[ScoreCell, ...]], ...]


class TableLayout(NamedTuple):
    """One table of the page; its title is that of its first group.

    Attributes
    ----------
    is_folded : bool
        Whether a reader has to open it: details that would push the sequences out of sight.
    """

    columns: tuple[str, ...]
    over: str | None
    groups: tuple[RowGroup, ...]
    is_folded: bool = False


def lay_out_tables(tables: tuple[ScoreTable, ...]) -> tuple[TableLayout, ...]:
    """Put published figures below the measured ones that precede them, where columns agree.

    Tables of single scenes come last, folded, where they have many rows.
    """
    layouts: list[TableLayout] = []
    for table in tables:
        last = layouts[-1] if layouts else None
        if table.is_published and last and (last.columns[1:], last.over) == (table.columns[1:], table.over):
            layouts[-1] = last._replace(groups=(*last.groups, _group(table)))
        else:
            layouts.append(TableLayout(table.columns, table.over, (_group(table),)))
    details = [layout for layout in layouts[1:] if layout.columns[0] in SCENES]
    if sum(len(layout.groups[0].rows) for layout in details) <= MAX_UNFOLDED:
        return tuple(layouts)
    rest = (layout for layout in layouts if layout not in details)
    return (*rest, *(layout._replace(is_folded=True) for layout in details))


def _group(table: ScoreTable) -> RowGroup:
    num_columns = len(table.columns) - 1
    better = table.better or (Better.MORE,) * num_columns
    decimals = table.decimals or (1,) * num_columns
    columns = [[values[column] for _, values in table.rows] for column in range(num_columns)]
    is_compared = not table.is_published and table.columns[0] not in SCENES
    best = [_best(*column) if is_compared else None for column in zip(columns, better, decimals, strict=True)]

    def cell(value: float | None, column: int) -> ScoreCell:
        if value is None:
            return ScoreCell("", False)
        return ScoreCell(f"{value:.{decimals[column]}f}", round(value, decimals[column]) == best[column])

    rows = ((name, tuple(cell(value, column) for column, value in enumerate(values))) for name, values in table.rows)
    return RowGroup(table.title, table.is_published, tuple(rows))


def _best(values: list[float | None], better: Better | None, decimals: int) -> float | None:
    """Return the best value as printed; None where no two differ or none is better."""
    known = [round(value, decimals) for value in values if value is not None]
    if better is None or len(known) < 2 or min(known) == max(known):
        return None
    return max(known) if better is Better.MORE else min(known)
