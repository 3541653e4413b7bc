"""Progress of long work on standard error: a bar, few plain lines in a log, nothing if quiet."""

import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from contextvars import ContextVar
from typing import TypeVar

from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from moseg.workflows.process.notebook import print_notice
from moseg.workflows.process.progress_displays import Display, bars_console, open_display

PATIENCE_SEC = 1.0
"""Work that is usually short shows no bar before this time."""

Item = TypeVar("Item")
Observer = Callable[[str, Mapping[str, int], Mapping[str, int]], None]
"""A function of the name of the items, their numbers by stage, and the finished ones by stage."""

_observer: ContextVar[Observer | None] = ContextVar("observer", default=None)


@contextmanager
def observed_progress(observer: Observer) -> Iterator[None]:
    """Pass all progress that this thread makes in the block to `observer`, whether or not it is shown as well.

    The observer is called when work begins, and after each finished item; what it raises ends the work.
    """
    token = _observer.set(observer)
    try:
        yield
    finally:
        _observer.reset(token)


class _Details:
    """Whether each stage is shown for itself, for all progress of this process."""

    is_shown = False


def show_details(is_shown: bool) -> None:
    """Show each stage for itself from now on (``--verbose``), or one bar for all of them."""
    _Details.is_shown = is_shown


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
    is_detailed : bool
        Whether a log gets a line in regular intervals even without ``--verbose``: work of one stage that takes hours.
    """

    def __init__(
        self,
        totals: Mapping[str, int],
        quiet: bool = False,
        what: str = "artifacts",
        patience_sec: float = 0.0,
        is_detailed: bool = False,
    ):
        self._totals = {stage: total for stage, total in totals.items() if total}
        self._done: Counter[str] = Counter()
        self._quiet = quiet or not self._totals
        self._what = what
        self._patience_sec = patience_sec
        self._is_detailed = is_detailed
        self._display: Display | None = None
        self._started = time.monotonic()
        self._observer = _observer.get()

    def __enter__(self) -> "StageProgress":
        if not self._patience_sec:
            self._show()
        self._observe()
        return self

    def advance(self, stage: str, count: int = 1) -> None:
        """Count further finished items of `stage`."""
        self._done[stage] += count
        self._observe()
        if self._display is None and time.monotonic() - self._started >= self._patience_sec:
            self._show()
        if self._display is not None:
            self._display.update(stage, self._done)

    def each(self, stage: str, items: Iterable[Item]) -> Iterator[Item]:
        """Yield the items; each counts as finished when the next is drawn."""
        for item in items:
            yield item
            self.advance(stage)

    def __exit__(self, kind, *exception) -> None:
        if self._display is not None:
            self._display.close(self._done, kind is None)

    def _observe(self) -> None:
        if self._observer is not None and self._totals:
            self._observer(self._what, self._totals, self._done)

    def _show(self) -> None:
        if not self._quiet:
            is_detailed = _Details.is_shown or self._is_detailed
            self._display = open_display(self._totals, self._what, self._started, is_detailed)


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
            print_notice(f"{self._what} …")
            return
        columns = (SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn())
        self._bar = Progress(*columns, console=console, transient=True)
        self._bar.add_task(self._what, total=None)
        self._bar.start()
