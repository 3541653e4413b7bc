"""A sliding window over the calls that a Dask cluster runs."""

import time
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

from dask.highlevelgraph import HighLevelGraph, MaterializedLayer
from dask.task_spec import Task, TaskRef
from distributed import Client, Future, as_completed
from distributed.client import ClosedClientError

from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.remote_calls import Setup, run_call

CALLS_PER_THREAD = 64
"""Calls in the window for each thread of the cluster: seconds of work even with a few cheap calls among them."""
MIN_WINDOW = 512
"""Smallest number of calls in the window: the calls that wait for one long call, one for each section of a long video,
must not fill the window while there is other work. Client and scheduler hold some 20 kB for each."""
MAX_CHAIN = 64
"""Longest chain of calls in the window that wait for each other: the scheduler keeps a finished call as long as any
other call waits for it, directly or not."""
WATCH_SECONDS = 5.0
"""While no call finishes, the cluster is asked after its workers this often."""


class SubmissionWindow:
    """Calls that were submitted and whose results were not yet collected.

    The scheduler forgets a call as soon as its result is collected and no call in the window waits for it, so its
    memory and the client's do not grow with the number of calls.

    Parameters
    ----------
    client : Client
    setup : Setup
    watch : function without arguments
        Called again and again while no call finishes; what it raises ends the waiting.
    """

    def __init__(self, client: Client, setup: Setup, watch: Callable[[], None] = lambda: None):
        self._client = client
        self._setup = setup
        self._watch = watch
        # The scheduler would confuse calls of the same name of two runs. A task group is the name up to the first
        # hyphen, the stage, so that there are few groups.
        self._suffix = f"-{uuid.uuid4().hex}"
        self._futures: dict[str, Future] = {}
        # While a call is in the window the scheduler must not forget the calls that it waits for.
        self._awaited: dict[str, list[Future]] = {}
        self._depths: dict[str, int] = {}
        self._completed = as_completed(loop=client.loop)

    def __len__(self) -> int:
        return len(self._futures)

    def submit(self, calls: Sequence[Call], for_network: Mapping[str, int] | None = None) -> Sequence[Call]:
        """Submit calls, each after those it waits for; those that run a network take the resources `for_network`.

        Returns
        -------
        sequence of Call
            The rest, from the first call on that would make too long a chain: submit it again when more is collected.
        """
        layers: tuple[dict[str, Task], ...] = ({}, {})
        rest: Sequence[Call] = ()
        for number, call in enumerate(calls):
            # Collected calls are done.
            waits = [name for name in call.after if name in self._depths]
            depth = 1 + max((self._depths[name] for name in waits), default=0)
            if depth > MAX_CHAIN:
                calls, rest = calls[:number], calls[number:]
                break
            self._depths[call.name] = depth
            task = partial(run_call, self._setup, call.needs_gpu, call.function, call.arguments)
            key = call.name + self._suffix
            layers[call.needs_gpu][key] = Task(key, task, *(TaskRef(name + self._suffix) for name in waits))
            self._awaited[call.name] = [self._futures[name] for name in waits if name in self._futures]
        if not calls:
            return rest
        graph = HighLevelGraph(
            {
                "calls": MaterializedLayer(layers[False]),
                "networks": MaterializedLayer(
                    layers[True], annotations={"resources": for_network} if for_network else None
                ),
            },
            {"calls": set(), "networks": set()},
        )
        keys = [call.name + self._suffix for call in calls]
        # Calls that were submitted before go first, however soon after them this comes.
        futures = self._client.get(graph, keys, sync=False, fifo_timeout=0)
        self._futures |= zip((call.name for call in calls), futures, strict=True)
        self._completed.update(futures)
        return rest

    def collect(self) -> Iterator[tuple[str, Any]]:
        """Yield names and results of finished calls, at least of one; raise the first error among them after these."""
        self._wait()
        batch = self._completed.next_batch()
        failed = [future for future in batch if future.status in ("error", "cancelled")]
        done = [future for future in batch if future not in failed]
        for future, result in zip(done, self._gather(done), strict=True):
            name = self._name(future)
            del self._futures[name], self._awaited[name], self._depths[name]
            yield name, result
        for future in failed:
            raise CallError(self._name(future), future.exception())

    def _wait(self) -> None:
        """Wait until a call has finished, and watch the cluster meanwhile."""
        watch_at = time.monotonic() + WATCH_SECONDS
        while not self._completed.has_ready() and not self._completed.is_empty():
            with self._completed.thread_condition:
                # As Dask itself waits, which would not come back.
                self._completed.thread_condition.wait(timeout=0.1)
            if time.monotonic() >= watch_at:
                self._watch()
                watch_at = time.monotonic() + WATCH_SECONDS

    def _gather(self, done: Sequence[Future]) -> Sequence[Any]:
        """Return results; one whose worker has died since is computed again, which may fail."""
        try:
            return self._client.gather(done)
        except Exception:
            for future in done:
                if future.status == "error":
                    raise CallError(self._name(future), future.exception()) from None
            raise

    def _name(self, future: Future) -> str:
        return future.key.removesuffix(self._suffix)

    def close(self) -> None:
        """Have the scheduler forget the calls in the window."""
        if self._futures:
            # Dask closes the client when the scheduler is gone; then there is nothing to forget.
            with suppress(ClosedClientError):
                self._client.cancel(list(self._futures.values()))
        self._futures.clear()
        self._awaited.clear()
        self._depths.clear()


class CallError(Exception):
    """A failure of the call `name`, for the `reason` that its process or the cluster gives."""

    def __init__(self, name: str, reason: BaseException):
        super().__init__(name, reason)
        self.name = name
        self.reason = reason
