"""A runner of calls on the workers of a Dask cluster."""

from collections.abc import Callable, Iterable
from contextlib import closing
from itertools import islice
from typing import Any

from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.clusters import Cluster, as_cluster_errors
from moseg.workflows.cluster.placement import GPU
from moseg.workflows.cluster.submission_window import CALLS_PER_THREAD, MIN_WINDOW, SubmissionWindow


class DistributedRunner:
    """A runner on the workers of a Dask cluster; only references and reports pass through its scheduler."""

    def __init__(self, cluster: Cluster):
        self._cluster = cluster

    def run(self, calls: Iterable[Call], on_done: Callable[[str, Any], None]) -> None:
        """See `Runner.run`."""
        remaining = iter(calls)
        # Drawing a call may query the cluster too.
        with as_cluster_errors(self._cluster):
            waiting = list(islice(remaining, MIN_WINDOW))
            if not waiting:
                return
            with closing(SubmissionWindow(self._cluster.client(), self._cluster.setup, self._cluster.watch)) as window:
                while waiting or window:
                    if waiting:
                        needs_gpus = any(call.needs_gpu for call in waiting) and self._cluster.claim_gpus()
                        waiting = window.submit(waiting, {GPU: 1} if needs_gpus else None)
                        size = max(MIN_WINDOW, CALLS_PER_THREAD * self._cluster.admit_workers())
                    for name, result in window.collect():
                        on_done(name, result)
                    # Half a window at a time: each message to the scheduler costs some milliseconds.
                    if not waiting and len(window) <= size // 2:
                        waiting = list(islice(remaining, size - len(window)))

    def has_gpu(self) -> bool:
        """See `Runner.has_gpu`."""
        with as_cluster_errors(self._cluster):
            return self._cluster.claim_gpus()

    def num_workers(self) -> int:
        """See `Runner.num_workers`."""
        with as_cluster_errors(self._cluster):
            return max(1, self._cluster.num_threads())
