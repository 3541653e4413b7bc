"""Table of what each choice of a method gives, costs and allows, as `moseg backends --why` prints it."""

from collections.abc import Iterable, Sequence
from itertools import groupby

from rich.table import Table
from rich.text import Text

from moseg.workflows.stages.merits import Merit

NAME_WIDTH = 25
"""Of the longest name of weights, indented; a longer option is cut before its value."""


def merits_table(rows: Iterable[Merit], sources: Sequence[str]) -> Table:
    """Return a table whose names stay whole in a terminal of 80 columns.

    An option is above the weights that it can read; figures refer to `sources` by number.
    """
    table = Table(title="what each choice gives and costs")
    table.add_column("choice", no_wrap=True)
    table.add_column("gives")
    table.add_column("CPU seconds")
    table.add_column("licence", no_wrap=True)
    for choice, chosen in groupby(rows, key=lambda row: row.choice):
        table.add_section()
        table.add_row(Text(choice, style="bold"))
        for option, items in groupby(chosen, key=lambda row: row.option):
            for index, row in enumerate(items):
                if row.weights and index == 0:
                    table.add_row(_cut(option))
                name = f"  {row.weights}" if row.weights else _cut(option)
                table.add_row(name, _figure(row, sources), _seconds(row), row.licence.replace(", ", ",\n"))
    return table


def list_sources(rows: Iterable[Merit]) -> tuple[str, ...]:
    """Return who reports the figures, each once, in the order of the rows."""
    return tuple(dict.fromkeys(row.figure.source for row in rows if row.figure is not None))


def _cut(option: str) -> str:
    return option.replace("=", "=\n  ") if len(option) > NAME_WIDTH else option


def _figure(row: Merit, sources: Sequence[str]) -> str:
    return "-" if row.figure is None else f"{row.figure.text} [{1 + sources.index(row.figure.source)}]"


def _seconds(row: Merit) -> str:
    if row.seconds is None:
        return "-"
    return f"{row.seconds:.{0 if row.seconds >= 10 else 1}f} a {row.frames}"
