"""A matrix of two objects in words: with one object beside the background, there is only one pair to compare."""

from moseg.workflows.reports.content import Matrix
from moseg.workflows.reports.page.numbers import short_number

MIN_SIDE = 3
"""Rows of a matrix that is worth a picture."""


def read_pair(matrix: Matrix) -> str | None:
    """Return what a matrix over at most two named objects says; None for one that is larger or has no names."""
    labels, values = matrix.labels, matrix.values
    if not labels or len(labels) >= MIN_SIDE or len(labels) != len(values):
        return None
    if len(labels) == 1:
        return "nothing to compare"
    unit = f" {matrix.unit}" if matrix.unit else ""

    def text(row: int, column: int) -> str:
        value = float(values[row, column])
        return "no value" if value != value else f"{short_number(value)}{unit}"

    if not matrix.is_log:
        return text(0, 1)
    # A residual: the row's model applied to the column's object.
    return "; ".join(
        f"{name}: {text(place, place)} under its own model, {text(1 - place, place)} under the other's"
        for place, name in enumerate((labels[0], f"object {labels[1]}"))
    )
