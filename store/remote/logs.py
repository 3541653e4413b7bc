"""Logs of runs on an object store.

Objects cannot grow, so each append is an object of its own. Names are in order for each process, and no two processes
ever share one, not even two that had the same number one after the other.
"""

import itertools
import os
import uuid

from moseg.store.names import check_run_id
from moseg.store.owners import process_space
from moseg.store.remote.layout import LOGS
from moseg.store.remote.requests import Requests

_counter = itertools.count()
_writers: dict[int, str] = {}


class RemoteLogs:
    """The methods of `RemoteStore` on logs."""

    _requests: Requests

    def append_log(self, run_id: str, lines: bytes) -> None:
        self._requests.put(f"{LOGS}/{check_run_id(run_id)}/{_writer()}-{next(_counter):09d}.jsonl", lines)

    def read_log(self, run_id: str) -> list[bytes]:
        contents = self._requests.get_many(self._log_names(run_id)).values()
        return [line for content in contents for line in (content or b"").splitlines()]

    def logs(self) -> dict[str, float]:
        found: dict[str, float] = {}
        for item in self._requests.listing(LOGS):
            run_id = item.name.split("/")[1]
            found[run_id] = max(found.get(run_id, item.modified), item.modified)
        return found

    def remove_log(self, run_id: str) -> bool:
        names = self._log_names(run_id)
        self._requests.delete(names)
        return bool(names)

    def _log_names(self, run_id: str) -> list[str]:
        return sorted(item.name for item in self._requests.listing(f"{LOGS}/{check_run_id(run_id)}"))


def _writer() -> str:
    """Return the name of this process, forked or not."""
    pid = os.getpid()
    return _writers.setdefault(pid, f"{process_space()}-{pid}-{uuid.uuid4().hex}")
