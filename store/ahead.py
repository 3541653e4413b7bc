"""Concurrent reads of many artifacts from a store behind a network."""

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TypeVar

from moseg.store.local import LocalStore
from moseg.store.protocol import ArtifactStore

REMOTE_READS = 32
"""Artifacts read at the same time from a store behind a network, where each answer takes 10 ms to 100 ms."""

Item = TypeVar("Item")
Result = TypeVar("Result")


def map_reads(store: ArtifactStore, read: Callable[[Item], Result], items: Iterable[Item]) -> Iterator[Result]:
    """Apply a function that reads from a store to items, in order; concurrently if the store is behind a network.

    On a disk the work is parsing and checking: two threads of one interpreter took three times as long as one.
    """
    return map(read, items) if isinstance(store, LocalStore) else map_ahead(read, items, REMOTE_READS)


def map_ahead(function: Callable[[Item], Result], items: Iterable[Item], num_threads: int) -> Iterator[Result]:
    """Apply a function to items, in order, `num_threads` calls at a time, at most twice as many ahead of the reader."""
    waiting: deque[Future[Result]] = deque()
    pool = ThreadPoolExecutor(num_threads, thread_name_prefix="moseg-store")
    try:
        for item in items:
            waiting.append(pool.submit(function, item))
            if len(waiting) >= 2 * num_threads:
                yield waiting.popleft().result()
        while waiting:
            yield waiting.popleft().result()
    finally:
        pool.shutdown(cancel_futures=True)
