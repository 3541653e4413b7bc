"""Matrices as heat maps in the colours of viridis: table cells where they are few, a picture where they are many."""

import functools
from typing import NamedTuple

import cv2
import numpy as np

from moseg.workflows.reports.content import Matrix, Picture
from moseg.workflows.reports.page.numbers import short_number
from moseg.workflows.reports.page.viewer import data_url

MAX_SIDE_WITH_NUMBERS = 12
MAX_SIDE_WITH_CELLS = 40
NEGLIGIBLE = 1e-4
BRIGHTEST_PERCENTILE = 99
"""Of the values off the diagonal, in a picture: the diagonal is 1 and would leave all other values dark."""
NUM_STEPS = 64
"""Steps of the colour scale, each a class of the style."""


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


def gather_heat_map(matrix: Matrix) -> HeatMap:
    """Return a matrix as a page shows it."""
    values = np.asarray(matrix.values, np.float64)
    ends = _range(values, matrix.is_log)
    is_picture = len(matrix.labels) != len(values) or len(values) > MAX_SIDE_WITH_CELLS
    whole = ends
    if is_picture and ends is not None and not matrix.is_log:
        ends = _cut(values, ends)
    positions = _positions(values, ends, matrix.is_log)
    steps = _steps_of(positions)
    cells = tuple(
        tuple(Cell(int(step), _text(float(value), ends, matrix.is_log)) for step, value in zip(*row, strict=True))
        for row in (() if is_picture else zip(steps, values, strict=True))
    )
    return HeatMap(
        matrix=matrix,
        cells=cells,
        picture=_paint(steps) if is_picture and values.size else None,
        has_numbers=len(values) <= MAX_SIDE_WITH_NUMBERS,
        ticks=_ticks(ends, matrix.is_log),
        has_missing=bool(np.isnan(values).any()),
        is_cut=ends != whole,
    )


def colour_map_style() -> str:
    """Return CSS with a class ``vN`` for each step, and the scale as a gradient in ``.scale``."""
    names = ["#{:02x}{:02x}{:02x}".format(*rgb) for rgb in _colours()]
    rules = [
        f".v{step}{{background:{name};color:{'#000' if _is_light(rgb) else '#fff'}}}"
        for step, (name, rgb) in enumerate(zip(names, _colours(), strict=True))
    ]
    return "\n".join([*rules, f".scale{{background:linear-gradient(to right,{','.join(names)})}}"])


def _range(values: np.ndarray, is_log: bool) -> tuple[float, float] | None:
    """Return the smallest and largest value with a colour of its own; None where no entry has one."""
    finite = values[np.isfinite(values) & ((values > 0) | (not is_log))]
    return (float(finite.min()), float(finite.max())) if finite.size else None


def _cut(values: np.ndarray, ends: tuple[float, float]) -> tuple[float, float]:
    """Return the ends of a picture's scale, the upper one at a percentile of the values off the diagonal."""
    others = values[~np.eye(*values.shape, dtype=bool)]
    others = others[np.isfinite(others)]
    if not others.size:
        return ends
    upper = float(np.percentile(others, BRIGHTEST_PERCENTILE))
    return (ends[0], upper) if ends[0] < upper < ends[1] else ends


def _positions(values: np.ndarray, ends: tuple[float, float] | None, is_log: bool) -> np.ndarray:
    """Return the position 0..1 of each entry on the scale, NaN where there is no value."""
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
    """Format a value for its cell: on a linear scale, values far below the largest one are printed as zero."""
    is_tiny = ends is not None and not is_log and 0 < abs(value) < NEGLIGIBLE * max(map(abs, ends))
    return "≈0" if is_tiny else short_number(value)


@functools.cache
def _colours() -> np.ndarray:
    """Return the steps of viridis, uint8 (NUM_STEPS, 3), RGB."""
    grey = np.linspace(0, 255, NUM_STEPS).round().astype(np.uint8)
    return np.ascontiguousarray(cv2.applyColorMap(grey[:, None], cv2.COLORMAP_VIRIDIS)[:, 0, ::-1])


def _is_light(rgb: np.ndarray) -> bool:
    """Return whether black has more contrast than white on a colour, by the relative luminance of WCAG 2."""
    channel = rgb / 255
    linear = np.where(channel <= 0.04045, channel / 12.92, ((channel + 0.055) / 1.055) ** 2.4)
    return bool(linear @ (0.2126, 0.7152, 0.0722) > 0.179)


def _steps_of(positions: np.ndarray) -> np.ndarray:
    """Return steps of positions on the scale, 0..1; int64 of the same shape, -1 for NaN."""
    steps = np.clip(np.nan_to_num(positions) * NUM_STEPS, 0, NUM_STEPS - 1).astype(np.int64)
    return np.where(np.isnan(positions), -1, steps)


def _paint(steps: np.ndarray) -> str:
    """Return the data URL of a PNG with one pixel a step, transparent where there is none."""
    alpha = np.where(steps < 0, 0, 255).astype(np.uint8)
    rgba = np.concatenate([_colours()[np.maximum(steps, 0)], alpha[..., None]], axis=-1)
    png = cv2.imencode(".png", cv2.cvtColor(rgba, cv2.COLOR_RGBA2BGRA))[1]
    return data_url(Picture("image/png", png.tobytes(), *steps.shape[::-1]))
