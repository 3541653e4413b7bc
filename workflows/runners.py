"""Running calls that depend on each other: in this process, on local workers, or on an existing Dask cluster."""

import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import partial
from typing import Any, NamedTuple, Protocol

import dask
from dask.callbacks import Callback
from dask.highlevelgraph import HighLevelGraph, MaterializedLayer
from distributed import Client, LocalCluster, as_completed

from schemas.errors import InputError
from workflows.devices import current_device, parse_device, read_device, set_device
from workflows.interrupts import defer_interrupts
from workflows.memory import allocation_environ, keep_freed_memory
from workflows.placement import GPU, ForeignGpus, Gpus, OwnGpus
from workflows.threads import pin_threads, thread_environ


class Call(NamedTuple):
    """A function, its arguments, and the names of the calls that it waits for (their results follow the arguments).

    A call that runs a network has `needs_gpu`: where there are GPUs, no other such call shares its own.
    """

    name: str
    function: Callable[..., Any]
    arguments: tuple
    after: tuple[str, ...] = ()
    needs_gpu: bool = False


class Runner(Protocol):
    """Runs calls in an order that their dependencies allow."""

    def run(self, calls: Sequence[Call], on_done: Callable[[str, Any], None]) -> None:
        """Run all `calls` (each listed after those it waits for); tell `on_done` each name and result; raise the first
        error."""

    def has_gpu(self) -> bool:
        """Whether calls that run a network run it on a GPU; raises InputError where one was asked for in vain."""

    def num_workers(self) -> int:
        """How many calls run at the same time."""


class SynchronousRunner:
    """One call after the other in this process."""

    def run(self, calls: Sequence[Call], on_done: Callable[[str, Any], None]) -> None:
        """See `Runner.run`."""

        def posttask(key, result, dsk, state, worker_id):
            on_done(key, result)

        with Callback(posttask=posttask):
            dask.get(_graph(calls), [call.name for call in calls])

    def has_gpu(self) -> bool:
        """See `Runner.has_gpu`."""
        return current_device().type != "cpu"

    def num_workers(self) -> int:
        """See `Runner.num_workers`."""
        return 1


class DistributedRunner:
    """On the workers of a Dask cluster; only references and reports travel through its scheduler."""

    def __init__(self, client: Client, gpus: Gpus):
        self._client = client
        self._gpus = gpus

    def run(self, calls: Sequence[Call], on_done: Callable[[str, Any], None]) -> None:
        """See `Runner.run`."""
        has_gpus = any(call.needs_gpu for call in calls) and self._gpus.claim()
        # The scheduler would take a call of the same name, of another or an earlier run, for this one.
        suffix = f"-{uuid.uuid4().hex}"
        graph = _graph(calls, {GPU: 1} if has_gpus else None, suffix)
        futures = self._client.get(graph, [call.name + suffix for call in calls], sync=False)
        try:
            for future, result in as_completed(futures, with_results=True):
                on_done(future.key.removesuffix(suffix), result)
        finally:
            self._client.cancel(futures)

    def has_gpu(self) -> bool:
        """See `Runner.has_gpu`."""
        return self._gpus.claim()

    def num_workers(self) -> int:
        """See `Runner.num_workers`."""
        return max(1, sum(self._client.nthreads().values()))


@contextmanager
def open_runner(
    workers: int = 0, scheduler: str | None = None, device: str = "auto", threads: int = 1
) -> Iterator[Runner]:
    """A runner for the block: synchronous for 0 workers, else local worker processes or the cluster at `scheduler`.

    Parameters
    ----------
    workers : int
    scheduler : str, optional
        Address of an existing cluster.
    device : str
        Where networks run, see `parse_device`. Each CUDA device goes to one local worker. In an existing cluster calls
        that run a network go to workers that declare the resource ``GPU``; for ``auto`` to any on its CPU where none
        does.
    threads : int
        CPU threads of each process.

    Raises
    ------
    InputError
        There is no such scheduler or device, or the numbers make no sense.
    """
    if scheduler is not None and workers:
        raise InputError("--workers and --scheduler exclude each other", got=f"{workers} and {scheduler}")
    if workers < 0:
        raise InputError("not a number of workers", where="--workers", got=workers, expected="0 (this process) or more")
    pin_threads(threads)
    keep_freed_memory()
    if scheduler is not None:
        read_device(device)
        with _connect(scheduler) as client:
            yield DistributedRunner(client, ForeignGpus(client, threads, device))
    elif workers == 0:
        set_device(device)
        yield SynchronousRunner()
    else:
        parse_device(device)
        settings = {
            "distributed.nanny.pre-spawn-environ": thread_environ(threads) | allocation_environ(),
            # Samples the stack of every worker a hundred times a second.
            "distributed.worker.profile.enabled": False,
        }
        with ExitStack() as stack:
            with defer_interrupts(), dask.config.set(settings):
                cluster = LocalCluster(
                    n_workers=workers,
                    threads_per_worker=1,
                    processes=True,
                    host="127.0.0.1",
                    dashboard_address="127.0.0.1:0",
                    silence_logs="CRITICAL",
                )
                client = stack.enter_context(Client(stack.enter_context(cluster)))
                runner = DistributedRunner(client, OwnGpus(client, threads, device))
            yield runner


def _connect(scheduler: str) -> Client:
    try:
        return Client(scheduler, timeout="10s")
    except (OSError, ValueError) as error:
        raise InputError(
            "no Dask scheduler answers", where=f"--scheduler {scheduler}", got=error, expected="tcp://host:8786"
        ) from error


def _graph(calls: Sequence[Call], for_network: Mapping[str, int] | None = None, suffix: str = "") -> HighLevelGraph:
    """Calls as tasks of a Dask graph; those that run a network take the resources `for_network`, keys end in `suffix`.

    Written out, because each `Delayed` holds a list of all that it waits for: over a video's length these grow by its
    square.
    """
    layers: dict[str, MaterializedLayer] = {}
    dependencies: dict[str, set[str]] = {}
    for call in calls:
        key = call.name + suffix
        waits = [name + suffix for name in call.after if name + suffix in layers]
        # Bound, because Dask would search arguments for keys.
        task = (partial(call.function, *call.arguments), *waits)
        resources = {"resources": for_network} if call.needs_gpu and for_network else None
        layers[key] = MaterializedLayer({key: task}, annotations=resources)
        dependencies[key] = set(waits)
    return HighLevelGraph(layers, dependencies)
