"""Cache of the arrays that this process has read or written, for the next task that reads them."""

from collections import OrderedDict
from collections.abc import Mapping
from threading import Lock

import numpy as np

CACHE_BYTES = 384 * 2**20
"""Size of a hundred 480p flows, which the flow models of a sequence of usual length read one after the other."""


class ArrayCache:
    """Cache of the most recently used arrays, read-only and bounded in bytes; an artifact never changes."""

    def __init__(self, limit: int):
        self._limit = limit
        self._arrays: OrderedDict[tuple[str, str, str], np.ndarray] = OrderedDict()
        self._nbytes = 0
        # A worker of a user's own cluster may run several tasks at a time.
        self._lock = Lock()

    def find(self, url: str, ref: str, name: str) -> np.ndarray | None:
        """Return an array if the cache holds it, else None."""
        entry = (url, ref, name)
        with self._lock:
            if entry not in self._arrays:
                return None
            self._arrays.move_to_end(entry)
            return self._arrays[entry]

    def keep(self, url: str, ref: str, arrays: Mapping[str, np.ndarray]) -> None:
        """Keep an artifact's arrays as the store would return them, and drop the least recently used ones."""
        for name, array in arrays.items():
            # In another memory order, sums over the array would be rounded differently from sums over the stored array.
            kept = np.asarray(array, order="C")
            # A part of an array would keep all of it in memory.
            is_part = isinstance(kept.base, np.ndarray) and kept.base.nbytes > kept.nbytes
            kept = kept.copy() if is_part else kept.view()
            kept.flags.writeable = False
            with self._lock:
                self._insert((url, ref, name), kept)

    def drop(self, url: str, ref: str) -> None:
        """Drop an artifact's arrays."""
        with self._lock:
            for entry in [entry for entry in self._arrays if entry[:2] == (url, ref)]:
                self._nbytes -= self._arrays.pop(entry).nbytes

    def _insert(self, entry: tuple[str, str, str], kept: np.ndarray) -> None:
        if entry in self._arrays or kept.nbytes > self._limit:
            return
        self._arrays[entry] = kept
        self._nbytes += kept.nbytes
        while self._nbytes > self._limit:
            _, dropped = self._arrays.popitem(last=False)
            self._nbytes -= dropped.nbytes


ARRAYS = ArrayCache(CACHE_BYTES)
"""Cache of this process."""
