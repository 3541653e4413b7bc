"""The events of a run: each process appends lines to the run's log in the store."""

import os
import platform
import time
import uuid
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, suppress
from datetime import UTC, datetime
from functools import cache

from moseg.schemas.errors import StoreError
from moseg.schemas.events import Event, EventKind, TroubleEvent, WorkEvent, write_event
from moseg.store import ArtifactStore

LOG_SHARE = 0.01
"""Part of a call's time that its log may take, in addition to one append when it begins and one when it ends."""
MAX_APPEND_BYTES = 1 << 22
"""A longer plan is written in several appends, so that its lines are never in memory together."""
MAX_MESSAGE = 2000
"""Characters of an error that are kept."""

_WRITTEN = "while computing "


def new_run_id() -> str:
    """Return a unique name for a run; names sort by the start of their runs, to a fraction of a millisecond."""
    now = datetime.now(UTC)
    fraction = now.microsecond * 0x1000 // 1_000_000
    return f"{now:%Y%m%dT%H%M%S}-{fraction:03x}{uuid.uuid4().hex[:5]}"


class EventLog(AbstractContextManager):
    """This process's part of a run's log; without a run nothing is written.

    On a disk an append takes some ten microseconds, on an object store some ten milliseconds. Lines that can wait do so
    until the append takes a hundredth of the time since the last one; the others are written when the block ends.

    Raises
    ------
    StoreError
        By every method, where the store cannot be written to.
    """

    def __init__(self, store: ArtifactStore, run_id: str | None):
        self._store = store
        self._run_id = run_id
        self._waiting: list[bytes] = []
        self._next_append = 0.0

    def __exit__(self, kind, *exception) -> None:
        if kind is None:
            self.flush()
            return
        # A full disk that stopped the work stops its log too, and is reported once.
        with suppress(StoreError):
            self.flush()

    def write(self, events: Iterable[Event]) -> None:
        """Write events now."""
        self._wait(events)
        self.flush()

    def add(self, *events: Event) -> None:
        """Write events now or a little later."""
        self._wait(events)
        if time.perf_counter() >= self._next_append:
            self.flush()

    def flush(self) -> None:
        """Write the lines that wait."""
        waiting, self._waiting = self._waiting, []
        self.write_lines(waiting)

    def write_lines(self, lines: Iterable[bytes]) -> None:
        """Write whole lines now, in as few appends as fit into memory."""
        if self._run_id is None:
            return
        for content in _join(lines):
            started = time.perf_counter()
            self._store.append_log(self._run_id, content)
            now = time.perf_counter()
            self._next_append = now + (now - started) / LOG_SHARE

    def _wait(self, events: Iterable[Event]) -> None:
        if self._run_id is not None:
            self._waiting.extend(map(write_event, events))


def this_process() -> dict:
    """Return time, host and process, with which most lines begin."""
    return {"time": datetime.now(UTC), "host": _host(), "pid": os.getpid()}


def work_event(kind: EventKind, ref: str, seconds: float | None = None) -> WorkEvent:
    """Return the event of a step of an artifact's computation in this process, now."""
    return WorkEvent(event=kind, ref=ref, seconds=seconds, **this_process())


def failed_event(error: BaseException, ref: str | None = None) -> TroubleEvent:
    """Return the event of a failure of one artifact, or of the run."""
    return TroubleEvent(event=EventKind.FAILED, ref=ref, message=describe_error(error), **this_process())


def as_unicode(text: str) -> str:
    """Return text of arguments or paths, in which bytes of another encoding are written as ``\\udcfc``."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")


def describe_error(error: BaseException) -> str:
    """Return one line about an error; it begins with the class of an error that is not this program's own."""
    text = as_unicode(" ".join(str(error).split()))
    if not type(error).__module__.startswith("moseg.schemas."):
        text = f"{type(error).__name__}: {text}".removesuffix(": ")
    return text if len(text) <= MAX_MESSAGE else f"{text[: MAX_MESSAGE - 1]}…"


def note_written(error: BaseException, *refs: str) -> None:
    """Add a note to an error that the artifacts were being computed; it also marks the error as logged."""
    error.add_note(f"{_WRITTEN}{' '.join(refs)}")


def is_written(error: BaseException) -> bool:
    """Return whether the process in which the error occurred has written it to the log."""
    return bool(written_refs(error))


def written_refs(error: BaseException) -> list[str]:
    """Return the artifacts that were being computed together when an error occurred; empty if it is not in the log."""
    notes = getattr(error, "__notes__", ())
    return [ref for note in notes if note.startswith(_WRITTEN) for ref in note.removeprefix(_WRITTEN).split()]


def _join(lines: Iterable[bytes]) -> Iterator[bytes]:
    joined = bytearray()
    for line in lines:
        joined += line
        if len(joined) >= MAX_APPEND_BYTES:
            yield bytes(joined)
            joined.clear()
    if joined:
        yield bytes(joined)


@cache
def _host() -> str:
    return platform.node()
