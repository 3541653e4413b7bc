"""Running calls that depend on each other: in this process, on local workers, or on an existing Dask cluster."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from importlib import import_module
from typing import Any, NamedTuple, Protocol

import dask
from dask.callbacks import Callback
from dask.delayed import Delayed, delayed
from distributed import Client, LocalCluster, WorkerPlugin, as_completed

from schemas.errors import InputError
from workflows.interrupts import defer_interrupts
from workflows.threads import THREAD_VARIABLES, pin_threads

# Dask's own setting also has MALLOC_TRIM_THRESHOLD_, which makes glibc map and unmap memory for every flow field.
WORKER_ENVIRON = dict.fromkeys(THREAD_VARIABLES, "1")


class Call(NamedTuple):
    """A function, its arguments, and the names of the calls that it waits for (their results follow the arguments)."""

    name: str
    function: Callable[..., Any]
    arguments: tuple
    after: tuple[str, ...] = ()


class Runner(Protocol):
    """Runs calls in an order that their dependencies allow."""

    def run(self, calls: Sequence[Call], on_done: Callable[[str, Any], None]) -> None:
        """Run all `calls` (each listed after those it waits for); tell `on_done` each name and result; raise the first
        error."""


class SynchronousRunner:
    """One call after the other in this process."""

    def run(self, calls: Sequence[Call], on_done: Callable[[str, Any], None]) -> None:
        """See `Runner.run`."""
        graph = _delayed_graph(calls)

        def posttask(key, result, dsk, state, worker_id):
            if key in graph:
                on_done(key, result)

        with Callback(posttask=posttask):
            dask.compute(*graph.values(), scheduler="synchronous", optimize_graph=False)


class DistributedRunner:
    """On the workers of a Dask cluster; only references and reports travel through its scheduler."""

    def __init__(self, client: Client):
        self._client = client

    def run(self, calls: Sequence[Call], on_done: Callable[[str, Any], None]) -> None:
        """See `Runner.run`."""
        futures = self._client.compute(list(_delayed_graph(calls).values()), optimize_graph=False)
        try:
            for future, result in as_completed(futures, with_results=True):
                on_done(future.key, result)
        finally:
            self._client.cancel(futures)


class _PinThreads(WorkerPlugin):
    """Binds every worker, also one that joins later, to one thread."""

    name = "moseg-pin-threads"

    def setup(self, worker):
        pin_threads()
        # A worker that cannot import the tasks is found out now; a call sent to it would never come back.
        import_module("workflows.execution")


@contextmanager
def open_runner(workers: int = 0, scheduler: str | None = None) -> Iterator[Runner]:
    """A runner for the block: synchronous for 0 workers, else local worker processes or the cluster at `scheduler`."""
    if scheduler is not None and workers:
        raise InputError("--workers and --scheduler exclude each other", got=f"{workers} and {scheduler}")
    if workers < 0:
        raise InputError("not a number of workers", where="--workers", got=workers, expected="0 (this process) or more")
    pin_threads()
    if scheduler is not None:
        with _connect(scheduler) as client:
            yield _pinned(client)
    elif workers == 0:
        yield SynchronousRunner()
    else:
        with ExitStack() as stack:
            with defer_interrupts(), dask.config.set({"distributed.nanny.pre-spawn-environ": WORKER_ENVIRON}):
                cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",
                    silence_logs="CRITICAL",
                )
                client = stack.enter_context(Client(stack.enter_context(cluster)))
                runner = _pinned(client)
            yield runner


def _pinned(client: Client) -> DistributedRunner:
    try:
        client.register_plugin(_PinThreads())
    except ImportError as error:
        expected = "the same moseg on every worker"
        raise InputError("workers that cannot run moseg's tasks", got=error, expected=expected) from error
    return DistributedRunner(client)


def _connect(scheduler: str) -> Client:
    try:
        return Client(scheduler, timeout="10s")
    except (OSError, ValueError) as error:
        raise InputError(
            "no Dask scheduler answers", where=f"--scheduler {scheduler}", got=error, expected="tcp://host:8786"
        ) from error


def _delayed_graph(calls: Sequence[Call]) -> dict[str, Delayed]:
    graph: dict[str, Delayed] = {}
    for call in calls:
        function = delayed(call.function, pure=False, traverse=False)
        waits = [graph[name] for name in call.after if name in graph]
        graph[call.name] = function(*call.arguments, *waits, dask_key_name=call.name)
    return graph
