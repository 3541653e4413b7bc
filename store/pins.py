"""Pins: what each run needs, so that a collection keeps it.

A run that works pins every reference of its plan, stored or not yet, *before* it looks which are stored, with a
lease; when it ends it pins its results without one, or unpins. A leased pin holds while its process runs, and no
longer than the lease: a process of another host cannot be asked, so there only the lease counts.
"""

import os
import time
from collections.abc import Iterable

from pydantic import ValidationError

from moseg.schemas.errors import StoreError
from moseg.store.backend import Backend
from moseg.store.names import check_ref, check_run_id
from moseg.store.outcomes import Pin
from moseg.store.owners import is_running, process_space

FOLDER = "pins"


def pin(backend: Backend, run_id: str, refs: Iterable[str], lease_seconds: float | None = None) -> None:
    """Write a run's pin, in place of an earlier one."""
    path = _path(run_id)
    now = time.time()
    content = Pin(
        run_id=run_id,
        refs=tuple(check_ref(ref) for ref in refs),
        created=now,
        expires=None if lease_seconds is None else now + lease_seconds,
        space=process_space(),
        pid=os.getpid(),
    )
    backend.write_record(path, content.model_dump_json().encode("utf-8") + b"\n", "pin a run")


def unpin(backend: Backend, run_id: str) -> bool:
    """End a run's pin; False where there is none."""
    return backend.delete_record(_path(run_id), "unpin a run")


def pinned(backend: Backend) -> dict[str, Pin]:
    """The pins that hold now, by run.

    Raises StoreError where a pin cannot be read: to pass it over would let a collection delete what it keeps.
    """
    contents = [_read(backend, path, record) for path, record in backend.read_records(FOLDER).items()]
    return {content.run_id: content for content in contents if _holds(content)}


def pin_of(backend: Backend, run_id: str) -> Pin | None:
    """A run's pin where it holds now: one look-up, however many pins there are."""
    path = _path(run_id)
    record = backend.read_record(path)
    content = None if record is None else _read(backend, path, record)
    return content if content is not None and _holds(content) else None


def ended_pins(backend: Backend) -> dict[str, int]:
    """Paths of the pins that hold no longer, since their lease or their process ended, with their bytes."""
    records = backend.read_records(FOLDER)
    return {path: len(record) for path, record in records.items() if not _holds(_read(backend, path, record))}


def discard_ended(backend: Backend, paths: Iterable[str]) -> None:
    """Delete pins that hold no longer; what was pinned again since is passed over."""
    for path in paths:
        record = backend.read_record(path)
        if record is not None and not _holds(_read(backend, path, record)):
            backend.delete_record(path, "delete an ended pin")


def _read(backend: Backend, path: str, record: bytes) -> Pin:
    try:
        return Pin.model_validate_json(record)
    except ValidationError as error:
        where = f"{backend.url}/{path}"
        raise StoreError("unreadable pin", where=where, expected="a pin; delete the file to end it") from error


def _holds(content: Pin) -> bool:
    if content.expires is None:
        return True
    return content.expires > time.time() and is_running(content.space, content.pid) is not False


def _path(run_id: str) -> str:
    return f"{FOLDER}/{check_run_id(run_id)}.json"
