"""Wall time of a process by place, from samples of its threads' stacks every few milliseconds.

`start` begins the sampling of this process; in a Dask worker with this module as a preload, Dask begins it. The counts
are written when the process, or the worker, ends.
"""

import atexit
import json
import os
import sys
import threading
import time
from collections import Counter
from pathlib import Path
from types import FrameType

FOLDER_VARIABLE = "MOSEG_BENCH_SAMPLES"
"""Environment variable with the folder for the counts, one file per process."""
INTERVAL_SEC = 0.004
IDLE = "nothing of ours"

_PLACES = (
    ("task functions", "workflows/stages/task.py", "compute"),
    ("ingest", "workflows/engine/ingest.py", "run_ingest"),
    ("store.put", "/store/", "put"),
    ("imports", "<frozen importlib._bootstrap>", "_find_and_load"),
    ("start and end of workers", "distributed/deploy/", ""),
    ("start and end of workers", "workflows/cluster/local_workers.py", ""),
    ("start and end of workers", "workflows/cluster/existing_cluster.py", ""),
    ("graph", "workflows/graph/", ""),
    ("plan", "workflows/engine/planning.py", ""),
    ("pins", "/store/", "pin"),
    ("recall of ingest", "workflows/engine/ingest.py", ""),
    ("look-ups and reads", "/store/", ""),
    ("phases and batches", "workflows/engine/phases.py", ""),
    ("phases and batches", "workflows/engine/calls.py", ""),
    ("events", "workflows/runlog/events.py", ""),
    ("waiting for workers", "workflows/cluster/distributed_runner.py", "run"),
    ("waiting for workers", "workflows/cluster/runners.py", "run"),
    ("start and end of workers", "workflows/cluster/runners.py", ""),
    ("between task and store", "workflows/engine/execution.py", ""),
    ("other of the client", "workflows/", ""),
)
"""Names of places, by a part of the file's path and a function (any where empty). A sample counts for the first of
them that any thread is in: what a thread does beside a task function takes no time of its own."""


class StackSamples(threading.Thread):
    """Samples of the other threads of this process, counted by place, with the times of the first and the last."""

    def __init__(self):
        super().__init__(name="moseg-bench-samples", daemon=True)
        self._known: dict[object, int] = {}
        self._is_over = threading.Event()
        self._counts: Counter[int] = Counter()
        self._num_samples = 0
        self._began = time.perf_counter()

    def run(self) -> None:
        """Sample until `write`."""
        while not self._is_over.wait(INTERVAL_SEC):
            frames = sys._current_frames()
            rank = min(self._rank(frame) for thread, frame in frames.items() if thread != self.ident)
            self._num_samples += 1
            self._counts[rank] += 1

    def write(self) -> None:
        """Stop, and write seconds by place to a file of this process."""
        if self._is_over.is_set():
            return
        self._is_over.set()
        self.join()
        # By share, because a busy interpreter delays its samples.
        each = (time.perf_counter() - self._began) / max(1, self._num_samples)
        seconds: Counter[str] = Counter()
        for rank, count in self._counts.items():
            seconds[_PLACES[rank][0] if rank < len(_PLACES) else IDLE] += each * count
        role = (
            "worker"
            if "distributed.worker" in sys.modules and "moseg.workflows.cli.app" not in sys.modules
            else "client"
        )
        path = Path(os.environ[FOLDER_VARIABLE]) / f"{role}-{os.getpid()}.json"
        path.write_text(json.dumps(seconds))

    def _rank(self, frame: FrameType | None) -> int:
        best = len(_PLACES)
        while frame is not None:
            code = frame.f_code
            if code not in self._known:
                self._known[code] = _rank_of(code.co_filename.replace(os.sep, "/"), code.co_name)
            best = min(best, self._known[code])
            frame = frame.f_back
        return best


def start() -> StackSamples:
    """Start sampling this process until it ends."""
    samples = StackSamples()
    samples.start()
    atexit.register(samples.write)
    return samples


def dask_setup(worker) -> None:
    """Start sampling; Dask calls this in a worker with this module as a preload."""
    worker.moseg_bench_samples = start()


def dask_teardown(worker) -> None:
    """Write the samples; Dask calls this when the worker closes."""
    worker.moseg_bench_samples.write()


def _rank_of(path: str, function: str) -> int:
    for rank, (_, part, name) in enumerate(_PLACES):
        if part in path and name in ("", function):
            return rank
    return len(_PLACES)
