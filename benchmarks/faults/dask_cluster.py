"""A Dask cluster on this machine: a scheduler, and workers that can be killed."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from processes import Run, wait_until

_DASK = (sys.executable, "-m", "dask")


class DaskCluster:
    """A scheduler and the workers started for it, each of one thread."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._file = folder / "scheduler.json"
        options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(self._file))
        self._runs = [Run([*_DASK, "scheduler", *options], folder / "scheduler")]
        # It is written in place: it is incomplete until its end is there.
        wait_until(lambda: self._runs[0].is_over() or (self._file.exists() and self._file.read_text().endswith("}")))

    @property
    def address(self) -> str:
        """Return the value for ``--scheduler``."""
        return json.loads(self._file.read_text())["address"]

    def start_worker(self, has_nanny: bool) -> Run:
        """Start a worker; a nanny restarts it whenever it dies."""
        nanny = "--nanny" if has_nanny else "--no-nanny"
        place = self._folder / f"worker{len(self._runs)}"
        options = (nanny, "--host", "127.0.0.1", "--nthreads", "1", "--no-dashboard", "--local-directory", str(place))
        self._runs.append(Run([*_DASK, "worker", self.address, *options], place))
        return self._runs[-1]

    def close(self) -> None:
        """End the scheduler and all workers."""
        for run in reversed(self._runs):
            if not run.is_over():
                run.kill("group")
            run.wait()


@contextmanager
def serve_cluster(folder: Path) -> Iterator[DaskCluster]:
    """Start a cluster without workers for the block."""
    cluster = DaskCluster(folder)
    try:
        yield cluster
    finally:
        cluster.close()
