"""A store that takes a task's output while the next task computes."""

import copy
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager
from typing import NamedTuple

import numpy as np

from moseg.schemas.manifests import Manifest
from moseg.schemas.recipes import Recipe
from moseg.store import ArtifactStore, PutOutcome
from moseg.workflows.stages.registry import axes_of
from moseg.workflows.stages.task import Output

MAX_WAITING = 2
"""Outputs that may wait to be stored: enough to keep the thread busy, and few megabytes."""


class Put(NamedTuple):
    """An output that waits to be stored, and the seconds that its task took."""

    recipe: Recipe
    output: Output
    seconds: float
    outcome: "Future[PutOutcome]"


class WriteBehind(AbstractContextManager):
    """A store whose puts run in a thread; an array of an artifact that is not stored yet is read when it is.

    Digesting, encoding and writing take a seventh of the time of the tasks, and release the interpreter's lock: if a
    core is free they cost nothing.

    Parameters
    ----------
    store : ArtifactStore
    report : function of a Put
        Called, in the caller's thread and in order, for each put that has ended; the last ones when the block ends.
        The `outcome` of a failed put raises.
    """

    def __init__(self, store: ArtifactStore, report: Callable[[Put], None]):
        self._store = store
        self._report = report
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="moseg-writer")
        self._waiting: deque[Put] = deque()
        self._outcomes: dict[str, Future[PutOutcome]] = {}
        self._attributes: dict[str, Mapping] = {}

    def __exit__(self, kind, *exception) -> None:
        self._writer.shutdown(wait=True)
        # Outputs that were computed before a failure are stored and reported, and the first failure is raised.
        failure: Exception | None = None
        while self._waiting:
            try:
                self._settle(0)
            except Exception as error:
                failure = failure or error
        if kind is None and failure is not None:
            raise failure

    @property
    def url(self) -> str:
        """URL of the store."""
        return self._store.url

    def put(self, recipe: Recipe, output: Output, seconds: float) -> None:
        """Queue an output for the store; wait if too many are not stored yet."""
        axes = axes_of(recipe.task, output.arrays)
        outcome = self._writer.submit(
            self._store.put, recipe, output.arrays, output.attributes, seconds=seconds, dims=axes
        )
        self._outcomes[recipe.ref] = outcome
        self._attributes[recipe.ref] = output.attributes
        self._waiting.append(Put(recipe, output, seconds, outcome))
        self._settle(MAX_WAITING)

    def has(self, ref: str) -> bool:
        """Return whether an artifact is stored, or was put here."""
        return ref in self._outcomes or self._store.has(ref)

    def manifest(self, ref: str) -> Manifest:
        """See `ArtifactStore.manifest`."""
        return self._stored(ref).manifest(ref)

    def attributes(self, ref: str) -> dict:
        """See `ArtifactStore.attributes`; until a put is reported, those that it was given."""
        if ref in self._attributes:
            # A store takes only values that it returns unchanged.
            return copy.deepcopy(dict(self._attributes[ref]))
        return self._stored(ref).attributes(ref)

    def read(self, ref: str, name: str) -> np.ndarray:
        """See `ArtifactStore.read`."""
        return self._stored(ref).read(ref, name)

    def read_rows(self, ref: str, name: str, start: int, stop: int) -> np.ndarray:
        """See `ArtifactStore.read_rows`."""
        return self._stored(ref).read_rows(ref, name, start, stop)

    def _stored(self, ref: str) -> ArtifactStore:
        if ref in self._outcomes:
            self._outcomes[ref].result()
        return self._store

    def _settle(self, max_waiting: int) -> None:
        """Report puts that have ended; wait until at most `max_waiting` have not."""
        while self._waiting and (len(self._waiting) > max_waiting or self._waiting[0].outcome.done()):
            put = self._waiting.popleft()
            wait([put.outcome])
            del self._attributes[put.recipe.ref]
            self._report(put)
