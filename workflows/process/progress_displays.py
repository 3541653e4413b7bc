"""Displays of progress: one bar or a bar for each stage on a terminal, a bar in a notebook, lines in a log."""

import sys
import time
from collections.abc import Mapping
from html import escape
from typing import Any, Protocol

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text

from moseg.workflows.process.notebook import Html, notebook

PLAIN_FIRST_SEC = 2.0
"""A log gets no line about work that took less time."""
PLAIN_INTERVAL_SEC = 15.0
"""Of lines in detail."""
NOTEBOOK_INTERVAL_SEC = 0.2
"""Each update of a notebook is a message to a browser."""


class Display(Protocol):
    """A display of the numbers of finished items by stage."""

    def update(self, stage: str, done: Mapping[str, int]) -> None:
        """Show the numbers after items of `stage` have finished."""

    def close(self, done: Mapping[str, int], is_finished: bool) -> None:
        """End the display; the work may have failed."""


def bars_console() -> Console | None:
    """Return the terminal to draw bars on, or None if standard error is not one that can redraw a line."""
    if sys.stderr is None or not sys.stderr.isatty():
        return None
    console = Console(stderr=True)
    return None if console.is_dumb_terminal else console


def open_display(totals: Mapping[str, int], what: str, started: float, is_detailed: bool) -> Display:
    """Return the display for where standard error goes.

    Parameters
    ----------
    totals : mapping of str to int
        Items by stage.
    what : str
        Name of the items.
    started : float
        Time of ``time.monotonic`` at which the work began, s.
    is_detailed : bool
        Whether each stage is shown for itself.
    """
    if (update := notebook()) is not None:
        return _NotebookBar(update, totals, what, started)
    console = bars_console()
    if console is None:
        return (_DetailedLines if is_detailed else _StageLines)(totals, what, started)
    return _StageBars(console, totals, what) if is_detailed else _OneBar(console, totals, what)


def _label(what: str, stage: str, totals: Mapping[str, int]) -> str:
    """Return what is done now: a single stage needs no name beside that of its items."""
    return what if len(totals) == 1 and what != "artifacts" else f"{what}: {stage.replace('_', ' ')}"


class _Left(TimeRemainingColumn):
    """The remaining time, named as such."""

    def render(self, task: Task) -> Text:
        text = super().render(task)
        return text.append(" left") if task.remaining else text


class _OneBar:
    """One bar for all stages, with the one at work; it leaves nothing behind."""

    def __init__(self, console: Console, totals: Mapping[str, int], what: str):
        self._labels = {stage: _label(what, stage, totals) for stage in totals}
        # Of one width, so that the bar stays where it is.
        width = max(map(len, self._labels.values()))
        self._bar = Progress(
            TextColumn(f"{{task.description:<{width}}}", markup=False),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            _Left(compact=True),
            console=console,
            expand=True,
            transient=True,
        )
        self._row = self._bar.add_task(next(iter(self._labels.values())), total=sum(totals.values()))
        self._bar.start()

    def update(self, stage: str, done: Mapping[str, int]) -> None:
        self._bar.update(self._row, description=self._labels.get(stage, ""), completed=sum(done.values()))

    def close(self, done: Mapping[str, int], is_finished: bool) -> None:
        self._bar.stop()


class _StageBars:
    """A bar for each stage, and one for all."""

    def __init__(self, console: Console, totals: Mapping[str, int], what: str):
        self._bars = Progress(
            TextColumn("{task.description:>20.20}", markup=False),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=console,
            expand=True,
        )
        shown = {**totals, "": sum(totals.values())} if len(totals) > 1 else totals
        self._rows = {stage: self._bars.add_task(stage or what, total=total) for stage, total in shown.items()}
        self._bars.start()

    def update(self, stage: str, done: Mapping[str, int]) -> None:
        for name, completed in ((stage, done[stage]), ("", sum(done.values()))):
            if name in self._rows:
                self._bars.update(self._rows[name], completed=completed)

    def close(self, done: Mapping[str, int], is_finished: bool) -> None:
        self._bars.stop()


class _StageLines:
    """Plain lines: at most one when a stage is done, the last of them at the end."""

    def __init__(self, totals: Mapping[str, int], what: str, started: float):
        self._totals, self._what, self._started = totals, what, started
        self._last = started

    def update(self, stage: str, done: Mapping[str, int]) -> None:
        now = time.monotonic()
        is_last = sum(done.values()) >= sum(self._totals.values())
        if done[stage] == self._totals.get(stage) and not is_last and now - self._last >= PLAIN_FIRST_SEC:
            self._last = now
            print(f"{_describe(self._totals, self._what, done, now - self._started)} ({stage} done)", file=sys.stderr)

    def close(self, done: Mapping[str, int], is_finished: bool) -> None:
        elapsed = time.monotonic() - self._started
        if is_finished and elapsed >= PLAIN_FIRST_SEC:
            print(_describe(self._totals, self._what, done, elapsed), file=sys.stderr, flush=True)


class _DetailedLines:
    """Plain lines of all stages: the first one soon, others seldom."""

    def __init__(self, totals: Mapping[str, int], what: str, started: float):
        self._totals, self._what, self._started = totals, what, started
        self._last = started + PLAIN_FIRST_SEC - PLAIN_INTERVAL_SEC

    def update(self, stage: str, done: Mapping[str, int]) -> None:
        if time.monotonic() - self._last >= PLAIN_INTERVAL_SEC:
            self._last = time.monotonic()
            self._print(done)

    def close(self, done: Mapping[str, int], is_finished: bool) -> None:
        if is_finished:
            self._print(done)

    def _print(self, done: Mapping[str, int]) -> None:
        stages = ", ".join(f"{stage} {done[stage]}/{total}" for stage, total in self._totals.items())
        line = _describe(self._totals, self._what, done, time.monotonic() - self._started)
        print(f"{line} ({stages})", file=sys.stderr, flush=True)


class _NotebookBar:
    """A bar below the cell of a notebook, which goes when the work is done."""

    def __init__(self, show: Any, totals: Mapping[str, int], what: str, started: float):
        self._totals, self._what, self._started = totals, what, started
        self._handle = show(self._draw(next(iter(totals)), dict.fromkeys(totals, 0)))
        self._last = started

    def update(self, stage: str, done: Mapping[str, int]) -> None:
        if time.monotonic() - self._last >= NOTEBOOK_INTERVAL_SEC:
            self._last = time.monotonic()
            self._handle.update(self._draw(stage, done))

    def close(self, done: Mapping[str, int], is_finished: bool) -> None:
        if is_finished:
            self._handle.update(Html("", ""))

    def _draw(self, stage: str, done: Mapping[str, int]) -> Html:
        total, elapsed = sum(self._totals.values()), time.monotonic() - self._started
        label = escape(_label(self._what, stage, self._totals))
        bar = f'<progress value="{sum(done.values())}" max="{total}" style="width: 20em"></progress>'
        return Html(f"{label} {bar} {sum(done.values())}/{total}{_remaining(self._totals, done, elapsed)}", "progress")


def _describe(totals: Mapping[str, int], what: str, done: Mapping[str, int], elapsed_sec: float) -> str:
    numbers = f"{sum(done.values())}/{sum(totals.values())}"
    return f"{numbers} {what} in {elapsed_sec:.0f} s{_remaining(totals, done, elapsed_sec)}"


def _remaining(totals: Mapping[str, int], done: Mapping[str, int], elapsed_sec: float) -> str:
    """Return the time left at the pace so far, in words; nothing where there is no pace, or nothing left."""
    finished, total = sum(done.values()), sum(totals.values())
    return f", about {elapsed_sec / finished * (total - finished):.0f} s left" if 0 < finished < total else ""
