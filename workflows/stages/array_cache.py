"""Arrays that this process has read or written, kept for the next task that reads them."""

from collections import OrderedDict
from collections.abc import Mapping
from threading import Lock

import numpy as np

CACHE_BYTES = 384 * 2**20
"""A hundred 480p flows: what the flow models of a sequence of common length read one after the other."""


class ArrayCache:
    """Least recently used arrays, read-only and bounded in bytes; sound because an artifact never changes."""

    def __init__(self, limit: int):
        self._limit = limit
        self._arrays: OrderedDict[tuple[str, str, str], np.ndarray] = OrderedDict()
        self._nbytes = 0
        # A worker of a cluster that is not ours may run several tasks at a time.
        self._lock = Lock()

    def find(self, url: str, ref: str, name: str) -> np.ndarray | None:
        """An array where it is kept, else None."""
        entry = (url, ref, name)
        with self._lock:
            if entry not in self._arrays:
                return None
            self._arrays.move_to_end(entry)
            return self._arrays[entry]

    def keep(self, url: str, ref: str, arrays: Mapping[str, np.ndarray]) -> None:
        """Keep an artifact's arrays just as a reader would get them; those used least give way."""
        for name, array in arrays.items():
            # Of another memory order, sums over it would be rounded otherwise than over what is read back.
            kept = np.asarray(array, order="C").view()
            kept.flags.writeable = False
            with self._lock:
                self._insert((url, ref, name), kept)

    def drop(self, url: str, ref: str) -> None:
        """Forget an artifact's arrays."""
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
"""Of this process."""
