"""Logs of runs on an object store.

Objects cannot grow, so each append is an object of its own. Names are in order for each process, and no two processes
ever share one, not even two with the same number one after the other.
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


def append_log(requests: Requests, run_id: str, lines: bytes) -> None:
    """Write lines as the next object of this process."""
    requests.put(f"{LOGS}/{check_run_id(run_id)}/{_writer()}-{next(_counter):09d}.jsonl", lines)


def read_log(requests: Requests, run_id: str) -> list[bytes]:
    """The lines of all objects of a run, those of each process in order."""
    contents = requests.get_many(_names(requests, run_id)).values()
    return [line for content in contents for line in (content or b"").splitlines()]


def logs(requests: Requests) -> dict[str, float]:
    """Runs that left a log, with the time of the last object."""
    found: dict[str, float] = {}
    for item in requests.listing(LOGS):
        run_id = item.name.split("/")[1]
        found[run_id] = max(found.get(run_id, item.modified), item.modified)
    return found


def remove_log(requests: Requests, run_id: str) -> bool:
    """Delete the objects of a run; False where there are none."""
    names = _names(requests, run_id)
    requests.delete(names)
    return bool(names)


def _names(requests: Requests, run_id: str) -> list[str]:
    return sorted(item.name for item in requests.listing(f"{LOGS}/{check_run_id(run_id)}"))


def _writer() -> str:
    """Name of this process, forked or not."""
    pid = os.getpid()
    return _writers.setdefault(pid, f"{process_space()}-{pid}-{uuid.uuid4().hex}")
