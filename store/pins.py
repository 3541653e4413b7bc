"""Pins: the references that each run needs, so that a collection keeps them.

A running run pins every reference of its plan, stored or not yet, *before* it looks up which are stored, with a lease;
when it ends it pins its results without a lease, or unpins. A leased pin holds while its process runs, and no longer
than the lease: whether a process of another host runs cannot be determined, so there only the lease counts.
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


def pin(
    backend: Backend,
    run_id: str,
    refs: Iterable[str],
    lease_seconds: float | None = None,
    *,
    run: str = "",
    with_inputs: bool = True,
) -> None:
    """See `ArtifactStore.pin`."""
    path = _path(run_id)
    now = time.time()
    content = Pin(
        run_id=run_id,
        refs=tuple(check_ref(ref) for ref in refs),
        created=now,
        expires=None if lease_seconds is None else now + lease_seconds,
        space=process_space(),
        pid=os.getpid(),
        run=run,
        with_inputs=with_inputs,
    )
    backend.write_record(path, content.model_dump_json().encode("utf-8") + b"\n", "pin a run")


def unpin(backend: Backend, run_id: str) -> bool:
    """See `ArtifactStore.unpin`."""
    return backend.delete_record(_path(run_id), "unpin a run")


def pinned(backend: Backend) -> dict[str, Pin]:
    """See `ArtifactStore.pinned`."""
    contents = [_read(backend, path, record) for path, record in backend.read_records(FOLDER).items()]
    return {content.run_id: content for content in contents if _holds(content)}


def pin_of(backend: Backend, run_id: str) -> Pin | None:
    """See `ArtifactStore.pin_of`."""
    path = _path(run_id)
    record = backend.read_record(path)
    content = None if record is None else _read(backend, path, record)
    return content if content is not None and _holds(content) else None


def ended_pins(backend: Backend) -> dict[str, int]:
    """Return the paths and bytes of pins that no longer hold, because their lease or their process ended."""
    records = backend.read_records(FOLDER)
    return {path: len(record) for path, record in records.items() if not _holds(_read(backend, path, record))}


def discard_ended(backend: Backend, paths: Iterable[str]) -> None:
    """Delete pins that no longer hold; skip those that were renewed since."""
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
