"""Pins: what each run needs, so that a collection keeps it.

A run that works pins every reference of its plan, stored or not yet, *before* it looks which are stored, with a
lease; when it ends it pins its results without one, or unpins. A leased pin holds while its process runs, and no
longer than the lease: a process of another host cannot be asked, so there only the lease counts.
"""

import os
import time
import uuid
from collections.abc import Iterable
from pathlib import Path

from pydantic import ValidationError

from schemas.errors import StoreError
from store.layout import Layout, check_ref, check_run_id
from store.outcomes import Pin
from store.owners import is_running, process_space


def pin(layout: Layout, run_id: str, refs: Iterable[str], lease_seconds: float | None = None) -> None:
    """Write a run's pin, in place of an earlier one."""
    target = _file(layout, run_id)
    now = time.time()
    content = Pin(
        run_id=run_id,
        refs=tuple(check_ref(ref) for ref in refs),
        created=now,
        expires=None if lease_seconds is None else now + lease_seconds,
        space=process_space(),
        pid=os.getpid(),
    )
    partial = target.with_name(f"{target.name}.{uuid.uuid4().hex}.partial")
    try:
        layout.pins.mkdir(exist_ok=True)
        partial.write_text(content.model_dump_json() + "\n", encoding="utf-8")
        partial.replace(target)
    except OSError as error:
        raise StoreError(f"cannot pin a run: {error.strerror}", where=layout.root, got=run_id) from error


def unpin(layout: Layout, run_id: str) -> bool:
    """End a run's pin; False where there is none."""
    try:
        _file(layout, run_id).unlink()
    except FileNotFoundError:
        return False
    except OSError as error:
        raise StoreError(f"cannot unpin a run: {error.strerror}", where=layout.root, got=run_id) from error
    return True


def pinned(layout: Layout) -> dict[str, Pin]:
    """The pins that hold now, by run.

    Raises StoreError where a pin cannot be read: to pass it over would let a collection delete what it keeps.
    """
    found = {}
    for path in sorted(layout.pins.glob("*.json")):
        try:
            content = Pin.model_validate_json(path.read_bytes())
        except FileNotFoundError:
            continue
        except (OSError, ValidationError) as error:
            raise StoreError("unreadable pin", where=path, expected="a pin; delete the file to end it") from error
        if _holds(content):
            found[content.run_id] = content
    return found


def _holds(content: Pin) -> bool:
    if content.expires is None:
        return True
    return content.expires > time.time() and is_running(content.space, content.pid) is not False


def _file(layout: Layout, run_id: str) -> Path:
    return layout.pins / f"{check_run_id(run_id)}.json"
