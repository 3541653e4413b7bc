"""Matrices as heat maps: cells of a table where they are few, a picture where they are many."""

import base64
from typing import NamedTuple

import cv2
import numpy as np

from moseg.workflows.reports.figure_content import Matrix
from moseg.workflows.reports.page.colour_map import paint, steps_of
from moseg.workflows.reports.page.numbers import short_number

LARGEST_WITH_NUMBERS = 12
LARGEST_WITH_CELLS = 40
NEGLIGIBLE = 1e-4
BRIGHTEST_PERCENTILE = 99
"""Of the values off the diagonal, in a picture of many: the diagonal is 1 and would leave all else dark."""


class Cell(NamedTuple):
    """A step on the colour scale, -1 where there is no value, and the value as text."""

    step: int
    text: str


class HeatMap(NamedTuple):
    """A matrix as a page shows it.

    Attributes
    ----------
    matrix : Matrix
    cells : tuple of tuple of Cell
        Empty where a picture stands for them.
    picture : str or None
        Data URL of a PNG with one pixel an entry.
    has_numbers : bool
        Whether its cells print their values.
    ticks : tuple of str
        Values at the left end, in the middle and at the right end of the colour bar; one where all are equal.
    has_missing : bool
        Whether some entries have no value.
    is_cut : bool
        Whether larger values than the right end of the scale have its colour.
    """

    matrix: Matrix
    cells: tuple[tuple[Cell, ...], ...]
    picture: str | None
    has_numbers: bool
    ticks: tuple[str, ...]
    has_missing: bool
    is_cut: bool


def _range(values: np.ndarray, is_log: bool) -> tuple[float, float] | None:
    """Least and largest value that has a colour of its own; None where no entry has."""
    finite = values[np.isfinite(values) & ((values > 0) | (not is_log))]
    return (float(finite.min()), float(finite.max())) if finite.size else None


def _cut(values: np.ndarray, ends: tuple[float, float]) -> tuple[float, float]:
    """The ends of a picture's scale: the upper one no more than nearly all that is off the diagonal needs."""
    others = values[~np.eye(*values.shape, dtype=bool)]
    others = others[np.isfinite(others)]
    if not others.size:
        return ends
    upper = float(np.percentile(others, BRIGHTEST_PERCENTILE))
    return (ends[0], upper) if ends[0] < upper < ends[1] else ends


def _positions(values: np.ndarray, ends: tuple[float, float] | None, is_log: bool) -> np.ndarray:
    """Position 0..1 of each entry on the scale, NaN where there is no value."""
    if ends is None or ends[0] == ends[1]:
        return np.where(np.isnan(values), np.nan, 0.5)
    low, high = np.log(ends) if is_log else ends
    with np.errstate(divide="ignore", invalid="ignore"):
        scaled = np.log(np.maximum(values, 0)) if is_log else values
    return np.clip((scaled - low) / (high - low), 0, 1)


def _ticks(ends: tuple[float, float] | None, is_log: bool) -> tuple[str, ...]:
    if ends is None:
        return ()
    low, high = ends
    if low == high:
        return (short_number(low),)
    middle = float(np.sqrt(low) * np.sqrt(high)) if is_log else (low + high) / 2
    return tuple(_text(value, ends, is_log) for value in (low, middle, high))


def _text(value: float, ends: tuple[float, float] | None, is_log: bool) -> str:
    """A value as its cell prints it: on a linear scale, what is far below the largest is as good as nothing."""
    is_tiny = ends is not None and not is_log and 0 < abs(value) < NEGLIGIBLE * max(map(abs, ends))
    return "≈0" if is_tiny else short_number(value)


def _encode(rgba: np.ndarray) -> str:
    png = cv2.imencode(".png", cv2.cvtColor(rgba, cv2.COLOR_RGBA2BGRA))[1]
    return f"data:image/png;base64,{base64.b64encode(png).decode()}"


def gather_heat_map(matrix: Matrix) -> HeatMap:
    """What a page shows of a matrix."""
    values = np.asarray(matrix.values, np.float64)
    ends = _range(values, matrix.is_log)
    is_picture = len(matrix.labels) != len(values) or len(values) > LARGEST_WITH_CELLS
    whole = ends
    if is_picture and ends is not None and not matrix.is_log:
        ends = _cut(values, ends)
    positions = _positions(values, ends, matrix.is_log)
    steps = steps_of(positions)
    cells = tuple(
        tuple(Cell(int(step), _text(float(value), ends, matrix.is_log)) for step, value in zip(*row, strict=True))
        for row in (() if is_picture else zip(steps, values, strict=True))
    )
    return HeatMap(
        matrix=matrix,
        cells=cells,
        picture=_encode(paint(positions)) if is_picture and values.size else None,
        has_numbers=len(values) <= LARGEST_WITH_NUMBERS,
        ticks=_ticks(ends, matrix.is_log),
        has_missing=bool(np.isnan(values).any()),
        is_cut=ends != whole,
    )
