"""Progress of long work on standard error: bars on a terminal, plain lines elsewhere, nothing when quiet."""

import sys
import time
from collections import Counter
from collections.abc import Mapping
from contextlib import AbstractContextManager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

PLAIN_INTERVAL_SEC = 15.0


class StageProgress(AbstractContextManager):
    """Counts what is done of each stage."""

    def __init__(self, totals: Mapping[str, int], quiet: bool = False):
        self._totals = {stage: total for stage, total in totals.items() if total}
        self._done: Counter[str] = Counter()
        self._quiet = quiet or not self._totals
        self._bars: Progress | None = None
        self._started = self._last = time.monotonic()

    def __enter__(self) -> "StageProgress":
        if not self._quiet and sys.stderr.isatty():
            self._bars = Progress(
                TextColumn("{task.description:>22}"),
                BarColumn(),
                MofNCompleteColumn(),
                TimeRemainingColumn(),
                console=Console(stderr=True),
            )
            self._rows = {stage: self._bars.add_task(stage, total=total) for stage, total in self._totals.items()}
            self._bars.start()
        return self

    def advance(self, stage: str, count: int = 1) -> None:
        """So many more artifacts of `stage` are done."""
        self._done[stage] += count
        if self._bars is not None:
            self._bars.advance(self._rows[stage], count)
        elif not self._quiet and time.monotonic() - self._last > PLAIN_INTERVAL_SEC:
            self._last = time.monotonic()
            self._print()

    def __exit__(self, kind, *exception) -> None:
        if self._bars is not None:
            self._bars.stop()
        elif not self._quiet and kind is None:
            self._print()

    def _print(self) -> None:
        done, total = self._done.total(), sum(self._totals.values())
        stages = ", ".join(f"{stage} {self._done[stage]}/{count}" for stage, count in self._totals.items())
        elapsed = time.monotonic() - self._started
        remaining = f", about {elapsed / done * (total - done):.0f} s left" if 0 < done < total else ""
        print(f"{done}/{total} artifacts in {elapsed:.0f} s{remaining} ({stages})", file=sys.stderr, flush=True)
