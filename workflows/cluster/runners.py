"""Runners of calls that depend on each other: in this process, on local workers, or on an existing Dask cluster.

Dask's distributed is imported for workers only, because that takes a third of a second.
"""

from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from itertools import islice
from typing import Any, Protocol

import dask
from dask.task_spec import Task, TaskRef

from moseg.schemas.errors import InputError
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.tls_files import TlsFiles
from moseg.workflows.process.devices import current_device, parse_device, read_device, set_device
from moseg.workflows.process.resources import check_bearable, keep_freed_memory, pin_threads

CALLS_AT_ONCE = 512
"""Calls that the synchronous scheduler is given at a time."""


class Runner(Protocol):
    """A way to run calls in an order that their dependencies allow."""

    def run(self, calls: Iterable[Call], on_done: Callable[[str, Any], None]) -> None:
        """Run all `calls` (each listed after those it waits for), pass each name and result to `on_done`, and raise the
        first error.

        Calls are drawn as there is room for them: of any number, only as many are held as fit into a window.
        """

    def has_gpu(self) -> bool:
        """Return whether calls that run a network run it on a GPU; raise InputError if a GPU was requested and there is
        none."""

    def num_workers(self) -> int:
        """Return how many calls run at the same time."""


class SynchronousRunner:
    """A runner of one call after the other in this process."""

    def run(self, calls: Iterable[Call], on_done: Callable[[str, Any], None]) -> None:
        """See `Runner.run`."""

        def posttask(key, result, dsk, state, worker_id):
            on_done(key, result)

        # Callbacks that a block registers belong to the whole process: runs in two threads would exchange them.
        start = start_state = pretask = finish = None
        callbacks = [(start, start_state, pretask, posttask, finish)]
        remaining = iter(calls)
        while calls := list(islice(remaining, CALLS_AT_ONCE)):
            names = {call.name for call in calls}
            graph = {
                call.name: Task(call.name, _run_after, call, *(TaskRef(name) for name in call.after if name in names))
                for call in calls
            }
            dask.get(graph, list(graph), callbacks=callbacks)

    def has_gpu(self) -> bool:
        """See `Runner.has_gpu`."""
        return current_device().type != "cpu"

    def num_workers(self) -> int:
        """See `Runner.num_workers`."""
        return 1


def _run_after(call: Call, *_done: object) -> Any:
    return call.function(*call.arguments)


@contextmanager
def open_runner(
    workers: int = 0,
    scheduler: str | None = None,
    device: str = "auto",
    threads: int = 1,
    tls: TlsFiles | None = None,
) -> Iterator[Runner]:
    """Open a runner for the block: synchronous for 0 workers, else local processes or the cluster at `scheduler`.

    Parameters
    ----------
    workers : int
        They start with the first call: a run that finds everything in the store starts no worker.
    scheduler : str, optional
        Address of an existing cluster, or its scheduler file.
    device : str
        Where networks run, see `parse_device`. Each CUDA device goes to one local worker. In an existing cluster calls
        that run a network go to workers that declare the resource ``GPU``; if none does, ``auto`` lets any worker run
        them on its CPU.
    threads : int
        CPU threads of each process.
    tls : TlsFiles, optional
        Certificates for a scheduler at ``tls://``.

    Raises
    ------
    InputError
        There is no such scheduler or device, or a number is out of range; or a process of the cluster has other code
        than this one, or misses a package.
    """
    if scheduler is not None and workers:
        raise InputError("--workers and --scheduler exclude each other", got=f"{workers} and {scheduler}")
    if workers < 0:
        raise InputError("not a number of workers", where="--workers", got=workers, expected="0 (this process) or more")
    check_bearable(workers, "workers")
    tls = tls or TlsFiles()
    if scheduler is None and tls.named():
        raise InputError("certificates are for --scheduler", where=next(iter(tls.named())), expected="tls://host:8786")
    pin_threads(threads)
    keep_freed_memory()
    if scheduler is not None:
        from moseg.workflows.cluster.distributed_runner import DistributedRunner
        from moseg.workflows.cluster.existing_cluster import ExistingCluster

        read_device(device)
        with closing(ExistingCluster(scheduler, tls, threads, device)) as cluster:
            yield DistributedRunner(cluster)
    elif workers == 0:
        set_device(device)
        yield SynchronousRunner()
    else:
        from moseg.workflows.cluster.distributed_runner import DistributedRunner
        from moseg.workflows.cluster.local_workers import LocalWorkers

        parse_device(device)
        with closing(LocalWorkers(workers, threads, device)) as cluster:
            yield DistributedRunner(cluster)
