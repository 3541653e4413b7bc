"""Progress of downloads on standard error: a bar on a terminal, plain lines elsewhere, nothing when quiet."""

import sys
import time
from contextlib import AbstractContextManager

from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TimeRemainingColumn, TransferSpeedColumn

from moseg.workflows.process.progress_displays import bars_console

PLAIN_INTERVAL_SEC = 15.0


class DownloadProgress(AbstractContextManager):
    """Display of the bytes received of one file."""

    def __init__(self, label: str, source: str, quiet: bool):
        self._label, self._source = label, source
        self._quiet = quiet
        self._bar: Progress | None = None
        self._done, self._total = 0, None
        self._started = self._last = time.monotonic()

    def __enter__(self) -> "DownloadProgress":
        console = None if self._quiet else bars_console()
        if console is not None:
            self._bar = Progress(
                TextColumn("{task.description}"),
                BarColumn(),
                DownloadColumn(),
                TransferSpeedColumn(),
                TimeRemainingColumn(),
                console=console,
            )
            self._row = self._bar.add_task(self._label, total=None)
            self._bar.start()
        elif not self._quiet:
            self._print(f"fetching {self._label} from {self._source}")
        return self

    def advance(self, done: int, total: int | None) -> None:
        """Show that `done` bytes were received, of `total` if that is known."""
        self._done, self._total = done, total
        if self._bar is not None:
            self._bar.update(self._row, completed=done, total=total)
        elif not self._quiet and time.monotonic() - self._last > PLAIN_INTERVAL_SEC:
            self._last = time.monotonic()
            self._print(f"{self._label}: {describe_size(done)} of {describe_size(total)}")

    def __exit__(self, kind, *exception) -> None:
        if self._bar is not None:
            self._bar.stop()
        elif not self._quiet and kind is None:
            elapsed = time.monotonic() - self._started
            self._print(f"{self._label}: {describe_size(self._done)} in {elapsed:.0f} s")

    def _print(self, line: str) -> None:
        print(line, file=sys.stderr, flush=True)


def describe_size(num_bytes: int | None) -> str:
    """Return a size in decimal units, as download pages give it."""
    if num_bytes is None:
        return "unknown size"
    size = float(num_bytes)
    for unit in ("B", "kB", "MB"):
        if size < 1000:
            return f"{size:.0f} {unit}"
        size /= 1000
    return f"{size:.2f} GB"
