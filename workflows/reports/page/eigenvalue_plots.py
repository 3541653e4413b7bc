"""Eigenvalues as points of a plot, in the coordinates of its SVG drawing."""

from typing import NamedTuple

import numpy as np

from moseg.workflows.reports.content import EigenvaluePlot
from moseg.workflows.reports.page.numbers import short_number

WIDTH, HEIGHT = 360, 215
LEFT, RIGHT, TOP, BOTTOM = 40, 8, 22, 38
MAX_SHOWN = 40


class Tick(NamedTuple):
    """A number and its position on its axis."""

    at: float
    text: str


class Point(NamedTuple):
    """An eigenvalue: its position, whether it counts as a motion, and its tooltip."""

    x: float
    y: float
    is_chosen: bool
    text: str


class Plot(NamedTuple):
    """A plot in a drawing of WIDTH x HEIGHT.

    Attributes
    ----------
    source : EigenvaluePlot
    series : tuple of tuple of Point
        One for each view; only one where the eigenvalues are of one matrix.
    x_ticks, y_ticks : tuple of Tick
    chosen_x : float
        Between the last eigenvalue that counts as a motion and the next one.
    num_shown, num_eigenvalues : int
    """

    source: EigenvaluePlot
    series: tuple[tuple[Point, ...], ...]
    x_ticks: tuple[Tick, ...]
    y_ticks: tuple[Tick, ...]
    chosen_x: float
    num_shown: int
    num_eigenvalues: int
    width: int = WIDTH
    height: int = HEIGHT
    left: int = LEFT
    right: int = WIDTH - RIGHT
    top: int = TOP
    bottom: int = HEIGHT - BOTTOM


def gather_plot(plot: EigenvaluePlot) -> Plot | None:
    """Return eigenvalues, of one matrix or a row for each view, as a page draws them; None where there are none."""
    eigenvalues = np.atleast_2d(np.asarray(plot.eigenvalues, np.float64))
    num_eigenvalues = eigenvalues.shape[1]
    shown = eigenvalues[:, : max(MAX_SHOWN, plot.num_motions + 5)]
    finite = shown[np.isfinite(shown)]
    if finite.size == 0:
        return None
    low, high = min(0.0, float(finite.min())), max(0.0, float(finite.max()))
    high = low + 1 if high == low else high + 0.04 * (high - low)
    num_shown = shown.shape[1]

    def x_of(index: float) -> float:
        return round(LEFT + (index + 0.5) / num_shown * (WIDTH - LEFT - RIGHT), 1)

    def y_of(value: float) -> float:
        return round(HEIGHT - BOTTOM - (value - low) / (high - low) * (HEIGHT - TOP - BOTTOM), 1)

    series = tuple(
        tuple(
            Point(x_of(index), y_of(value), index < plot.num_motions, f"{index + 1}: {short_number(float(value), 4)}")
            for index, value in enumerate(row)
            if np.isfinite(value)
        )
        for row in shown
    )
    numbers = range(1, num_shown + 1, -(-num_shown // 12))
    return Plot(
        source=plot,
        series=series,
        x_ticks=tuple(Tick(x_of(number - 1), str(number)) for number in numbers),
        y_ticks=tuple(Tick(y_of(value), short_number(float(value))) for value in _round_steps(low, high, 5)),
        chosen_x=x_of(min(plot.num_motions, num_shown) - 0.5),
        num_shown=num_shown,
        num_eigenvalues=num_eigenvalues,
    )


def _round_steps(low: float, high: float, max_steps: int) -> np.ndarray:
    """Return about `max_steps` round numbers from `low` to `high`, spaced by 1, 2 or 5 times a power of ten."""
    min_step = (high - low) / max_steps
    power = 10.0 ** np.floor(np.log10(min_step))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power >= min_step * (1 - 1e-9))
    return np.arange(np.ceil(low / step - 1e-9), np.floor(high / step + 1e-9) + 1) * step + 0.0
