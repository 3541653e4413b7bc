"""The status of a run, as read from its log."""

import time
from collections.abc import Collection, Iterable, Iterator
from datetime import UTC, datetime
from enum import StrEnum

from pydantic import ValidationError

from moseg.schemas.errors import InputError, StoreError
from moseg.schemas.events import Event, Outcome, RunClosed, RunOpened, SubjectEvent, line_time, read_event
from moseg.schemas.frozen import Frozen
from moseg.schemas.spelling import closest
from moseg.schemas.stretch_choice import StretchChoice
from moseg.store import ArtifactStore
from moseg.store.owners import is_running
from moseg.workflows.runlog.choices import read_choices
from moseg.workflows.runlog.status_counts import InFlight, RunCounts, StageStatus, Trouble

LATEST = "latest"
"""Name for the run that began last."""


class RunState(StrEnum):
    """The state of a run."""

    RUNNING = "running"
    FINISHED = "finished"
    FAILED = "failed"
    INTERRUPTED = "interrupted"
    DEAD = "dead"
    """Its process is gone, and the log has no line about its end."""


class RunStatus(Frozen):
    """A run's state and counts.

    Attributes
    ----------
    is_asked : bool
        Whether the process of a run that is not closed could be checked: on another host it counts as running.
    started, ended, last_event, asked : datetime
        Times of the first line, of the end of a run that ended, of the last line, and of this status.
    seconds : float
        From the start to the end, or to now.
    rest_seconds : float or None
        Estimate of the remaining time of a run at work; None as long as there is no basis for one.
    num_done, num_planned : int
        Artifacts to compute that are stored, and all of them.
    stages : tuple of StageStatus
        In the order in which they were planned.
    in_flight : tuple of InFlight
        What each process began last and has not ended.
    choices : dict of str to tuple of StretchChoice
        By sequence, sources of proposals that were left to the camera's motion.
    num_unreadable : int
        Lines of the log that this version cannot read or that were cut short; no other count includes them.
    """

    run_id: str
    state: RunState
    is_asked: bool
    command: tuple[str, ...]
    folder: str
    version: str
    host: str
    pid: int
    num_workers: int
    started: datetime
    ended: datetime | None
    last_event: datetime
    asked: datetime
    seconds: float
    rest_seconds: float | None
    num_done: int
    num_planned: int
    num_failed: int
    stages: tuple[StageStatus, ...]
    in_flight: tuple[InFlight, ...]
    failures: tuple[Trouble, ...]
    quarantined: tuple[Trouble, ...]
    choices: dict[str, tuple[StretchChoice, ...]] = {}
    message: str | None
    pins: tuple[str, ...]
    num_unreadable: int


def read_status(store: ArtifactStore, run_id: str) -> RunStatus:
    """Return the status of a run now; raise StoreError if its log cannot be read."""
    return summarise(run_id, _read_lines(store, run_id), datetime.now(UTC))


def read_events(store: ArtifactStore, run_id: str) -> Iterator[Event]:
    """Return the events of all processes of a run, by time; lines that are none are skipped."""
    return (event for event in _read_lines(store, run_id) if event is not None)


def summarise(run_id: str, events: Iterable[Event | None], now: datetime) -> RunStatus:
    """Return the status at the time `now` from events, by time; None stands for a line that cannot be read."""
    counts = RunCounts()
    opened: RunOpened | None = None
    closed: RunClosed | None = None
    last_event = None
    choices: dict[str, tuple[StretchChoice, ...]] = {}
    num_unreadable = 0
    for event in events:
        if event is None:
            num_unreadable += 1
            continue
        last_event = event.time
        if isinstance(event, RunOpened):
            opened = opened or event
        elif isinstance(event, RunClosed):
            closed = event
        elif isinstance(event, SubjectEvent):
            choices |= read_choices(event)
        else:
            counts.add(event)
    if opened is None:
        raise StoreError("a log without a beginning", where=f"run {run_id}", expected="a line with the event 'opened'")
    state, is_asked = _state(opened, closed)
    ended = closed.time if closed is not None else last_event if state == RunState.DEAD else None
    seconds = ((ended or now) - opened.time).total_seconds()
    return RunStatus(
        run_id=run_id,
        state=state,
        is_asked=is_asked,
        **opened.model_dump(include={"command", "folder", "version", "host", "pid", "num_workers"}),
        started=opened.time,
        ended=ended,
        last_event=last_event,
        asked=now,
        seconds=max(seconds, 0.0),
        rest_seconds=counts.rest_seconds(now) if state == RunState.RUNNING else None,
        num_done=counts.num_done(),
        num_planned=counts.num_planned(),
        num_failed=len(counts.failures),
        stages=counts.stages(),
        in_flight=counts.in_flight(),
        failures=tuple(counts.failures),
        quarantined=tuple(counts.quarantined),
        choices=choices,
        message=None if closed is None else closed.message,
        pins=() if closed is None else closed.pins,
        num_unreadable=num_unreadable,
    )


def find_run(store: ArtifactStore, name: str) -> str:
    """Return the run of this name, the only one whose name begins so, or the latest.

    Raises
    ------
    InputError
        There is none, or more than one.
    """
    known = list_runs(store)
    if name == LATEST and known:
        return known[0]
    found = [run_id for run_id in known if run_id.startswith(name)] if name else []
    if name in found:
        return name
    if not found:
        expected = "one of `moseg status`" if known else "a run that computed something in this store"
        close = closest(name, (LATEST, *known)) if known else None
        expected += "" if close is None else f"; did you mean {close!r}?"
        raise InputError("no such run", where=store.url, got=repr(name), expected=expected)
    if len(found) > 1:
        raise InputError("ambiguous run", got=name, expected=f"more letters: {len(found)} runs begin so")
    return found[0]


def list_runs(store: ArtifactStore) -> list[str]:
    """Return the runs that left a log, the latest first."""
    return sorted(store.logs(), reverse=True)


def old_logs(store: ArtifactStore, grace_seconds: float, forget: Collection[str] = ()) -> list[str]:
    """Return runs whose logs may be removed: none of their processes wrote within the grace period or is at work, and
    no pin but those of `forget` keeps their results, for which a report needs the log."""
    before = time.time() - grace_seconds
    # A run at work has a pin of its own name, but not while it decodes its sources.
    pinned = store.pinned().keys() - set(forget)
    old = sorted(run_id for run_id, changed in store.logs().items() if changed < before and run_id not in pinned)
    return [run_id for run_id in old if not _is_needed(store, run_id, pinned)]


def _is_needed(store: ArtifactStore, run_id: str, pinned: Collection[str]) -> bool:
    """Return whether a run's results are kept, or it has not closed and its process certainly runs."""
    try:
        lines = store.read_log(run_id)
    except StoreError:
        # A log that cannot be read now may be needed.
        return True
    events = [_read_line(line) for line in lines if b'"opened"' in line or b'"closed"' in line]
    closed = [event for event in events if isinstance(event, RunClosed)]
    if closed:
        return any(pin in pinned for event in closed for pin in event.pins)
    return any(isinstance(event, RunOpened) and is_running(event.space, event.pid) is True for event in events)


def _read_lines(store: ArtifactStore, run_id: str) -> Iterator[Event | None]:
    """Return the events of a run's lines by time, None for a line that is none.

    Lines are sorted before they are parsed: the events of a run of 100,000 artifacts would take a gigabyte.
    """
    # A stable sort: lines that one process wrote at the same time stay in their order.
    return map(_read_line, sorted(store.read_log(run_id), key=line_time))


def _read_line(line: bytes) -> Event | None:
    try:
        return read_event(line)
    except ValidationError:
        return None


def _state(opened: RunOpened, closed: RunClosed | None) -> tuple[RunState, bool]:
    if closed is not None:
        return _STATES[closed.outcome], True
    is_alive = is_running(opened.space, opened.pid)
    return (RunState.DEAD if is_alive is False else RunState.RUNNING), is_alive is not None


_STATES = {
    Outcome.FINISHED: RunState.FINISHED,
    Outcome.FAILED: RunState.FAILED,
    Outcome.INTERRUPTED: RunState.INTERRUPTED,
}
