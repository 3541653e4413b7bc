"""Calls under way on a Dask cluster: a sliding window over any number of them."""

import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import Any

from dask.highlevelgraph import HighLevelGraph, MaterializedLayer
from dask.task_spec import Task, TaskRef
from distributed import Client, Future, as_completed
from distributed.client import ClosedClientError

from moseg.workflows.cluster.calls import Call
from moseg.workflows.cluster.remote_calls import Setup, run_call

CALLS_PER_THREAD = 64
"""Calls in flight for each thread of the cluster: with a few brief ones among them still seconds of work."""
MIN_IN_FLIGHT = 512
"""Calls in flight at least: the calls that wait for one long call, one for each section of a long video, must not fill
the window while there is other work. Client and scheduler hold some 20 kB for each."""

MAX_CHAIN = 64
"""Calls in flight that wait for each other one after the other: the scheduler keeps what is done as long as anything
waits, over however many steps, for it."""


class Flight:
    """Calls that were submitted and whose results were not yet collected.

    Tasks are forgotten by the scheduler as soon as their results are collected and nothing in flight waits for them, so
    its memory and the client's do not grow with the number of calls.
    """

    def __init__(self, client: Client, setup: Setup):
        self._client = client
        self._setup = setup
        # The scheduler would take a call of the same name, of another or an earlier run, for this one. Its task group
        # is the name up to the first hyphen, the stage, so that groups stay few.
        self._suffix = f"-{uuid.uuid4().hex}"
        self._futures: dict[str, Future] = {}
        # While a call is in flight the scheduler must not forget what it waits for.
        self._awaited: dict[str, list[Future]] = {}
        self._depths: dict[str, int] = {}
        self._completed = as_completed(loop=client.loop)

    def __len__(self) -> int:
        return len(self._futures)

    def submit(self, calls: Sequence[Call], for_network: Mapping[str, int] | None = None) -> Sequence[Call]:
        """Send off calls, each after those it waits for; those that run a network take the resources `for_network`.

        Returns
        -------
        sequence of Call
            The rest, from the first one on that would make too long a chain: to be given again when more is collected.
        """
        layers: tuple[dict[str, Task], ...] = ({}, {})
        rest: Sequence[Call] = ()
        for number, call in enumerate(calls):
            # What was collected is done.
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
        # What was sent off before goes first, however soon after it this comes.
        futures = self._client.get(graph, keys, sync=False, fifo_timeout=0)
        self._futures |= zip((call.name for call in calls), futures, strict=True)
        self._completed.update(futures)
        return rest

    def collect(self) -> Iterator[tuple[str, Any]]:
        """Names and results of calls that are done, at least of one; raises the first error among them after these."""
        batch = self._completed.next_batch()
        failed = [future for future in batch if future.status in ("error", "cancelled")]
        done = [future for future in batch if future not in failed]
        for future, result in zip(done, self._gather(done), strict=True):
            name = self._name(future)
            del self._futures[name], self._awaited[name], self._depths[name]
            yield name, result
        for future in failed:
            raise CallError(self._name(future), future.exception())

    def _gather(self, done: Sequence[Future]) -> Sequence[Any]:
        """Results; one whose worker has died since is computed again, which may fail."""
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
        """Have the scheduler forget what is in flight."""
        if self._futures:
            # Dask closes the client when the scheduler is gone, and with it whatever it would have to forget.
            with suppress(ClosedClientError):
                self._client.cancel(list(self._futures.values()))
        self._futures.clear()
        self._awaited.clear()
        self._depths.clear()


class CallError(Exception):
    """The call `name` failed for the `reason` that its process or the cluster gives."""

    def __init__(self, name: str, reason: BaseException):
        super().__init__(name, reason)
        self.name = name
        self.reason = reason
