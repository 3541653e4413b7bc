"""Resident memory of processes while they run."""

import threading
from collections.abc import Sequence

import psutil

INTERVAL_SEC = 0.05


class MemorySamples(threading.Thread):
    """Largest resident memory of each process, sampled twenty times a second; shared pages count for each."""

    def __init__(self, pids: Sequence[int]):
        super().__init__(name="moseg-bench-memory", daemon=True)
        self._processes = [psutil.Process(pid) for pid in pids]
        self._peaks = [0] * len(pids)
        self._is_over = threading.Event()

    def run(self) -> None:
        """Sample until `stop`."""
        while not self._is_over.wait(INTERVAL_SEC):
            for index, process in enumerate(self._processes):
                self._peaks[index] = max(self._peaks[index], _resident(process))

    def stop(self) -> list[int]:
        """End the sampling and return the peaks in bytes, in the order of the processes."""
        self._is_over.set()
        self.join()
        return self._peaks


def _resident(process: psutil.Process) -> int:
    try:
        return process.memory_info().rss
    except psutil.NoSuchProcess:
        # The process has ended; its peak is already sampled.
        return 0
