"""Progress of long work on standard error: bars on a terminal, plain lines elsewhere, nothing if quiet."""

import sys
import threading
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from typing import TypeVar

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

PLAIN_FIRST_SEC = 2.0
PLAIN_INTERVAL_SEC = 15.0
PATIENCE_SEC = 1.0
"""Work that is usually short shows no bar before this time."""

Item = TypeVar("Item")


def bars_console() -> Console | None:
    """Return the terminal to draw bars on, or None if standard error is not one that can redraw a line."""
    if sys.stderr is None or not sys.stderr.isatty():
        return None
    console = Console(stderr=True)
    return None if console.is_dumb_terminal else console


class StageProgress(AbstractContextManager):
    """A count of finished work by stage.

    Parameters
    ----------
    totals : mapping of str to int
        Numbers of items by stage; stages without any are left out.
    quiet : bool
    what : str
        Name of the items.
    patience_sec : float
        Time before which nothing is shown.
    """

    def __init__(
        self, totals: Mapping[str, int], quiet: bool = False, what: str = "artifacts", patience_sec: float = 0.0
    ):
        self._totals = {stage: total for stage, total in totals.items() if total}
        self._done: Counter[str] = Counter()
        self._quiet = quiet or not self._totals
        self._what = what
        self._patience_sec = patience_sec
        self._bars: Progress | None = None
        self._started = time.monotonic()
        # So that the first line comes soon.
        self._last = self._started + PLAIN_FIRST_SEC - PLAIN_INTERVAL_SEC
        self._is_shown = False

    def __enter__(self) -> "StageProgress":
        if not self._patience_sec:
            self._show()
        return self

    def advance(self, stage: str, count: int = 1) -> None:
        """Count further finished items of `stage`."""
        self._done[stage] += count
        if self._quiet or (not self._is_shown and time.monotonic() - self._started < self._patience_sec):
            return
        self._show()
        if self._bars is not None:
            for name in (stage, ""):
                if name in self._rows:
                    self._bars.update(self._rows[name], completed=self._done[name] if name else self._done.total())
        elif time.monotonic() - self._last >= PLAIN_INTERVAL_SEC:
            self._last = time.monotonic()
            self._print()

    def each(self, stage: str, items: Iterable[Item]) -> Iterator[Item]:
        """Yield the items; each counts as finished when the next is drawn."""
        for item in items:
            yield item
            self.advance(stage)

    def __exit__(self, kind, *exception) -> None:
        if self._bars is not None:
            self._bars.stop()
        elif self._is_shown and kind is None:
            self._print()

    def _show(self) -> None:
        if self._quiet or self._is_shown:
            return
        self._is_shown = True
        console = bars_console()
        if console is None:
            return
        self._bars = Progress(
            TextColumn("{task.description:>20.20}", markup=False),
            BarColumn(bar_width=None),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TimeRemainingColumn(),
            console=console,
            expand=True,
        )
        totals = dict(self._totals)
        if len(totals) > 1:
            totals[""] = sum(totals.values())
        done = {**self._done, "": self._done.total()}
        self._rows = {
            stage: self._bars.add_task(stage or self._what, total=total, completed=done.get(stage, 0))
            for stage, total in totals.items()
        }
        self._bars.start()

    def _print(self) -> None:
        done, total = self._done.total(), sum(self._totals.values())
        stages = ", ".join(f"{stage} {self._done[stage]}/{count}" for stage, count in self._totals.items())
        elapsed = time.monotonic() - self._started
        remaining = f", about {elapsed / done * (total - done):.0f} s left" if 0 < done < total else ""
        line = f"{done}/{total} {self._what} in {elapsed:.0f} s{remaining} ({stages})"
        print(line, file=sys.stderr, flush=True)


class Waiting(AbstractContextManager):
    """A sign of work of unknown length, shown if it takes some time."""

    def __init__(self, what: str, quiet: bool = False):
        self._what = what
        self._bar: Progress | None = None
        self._timer = None if quiet else threading.Timer(PATIENCE_SEC, self._show)

    def __enter__(self) -> "Waiting":
        if self._timer is not None:
            self._timer.daemon = True
            self._timer.start()
        return self

    def __exit__(self, *exception) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer.join()
        if self._bar is not None:
            self._bar.stop()

    def _show(self) -> None:
        console = bars_console()
        if console is None:
            print(f"{self._what} …", file=sys.stderr, flush=True)
            return
        columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
        self._bar = Progress(*columns, console=console, transient=True)
        self._bar.add_task(self._what, total=None)
        self._bar.start()
