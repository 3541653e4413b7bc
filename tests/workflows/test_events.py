"""Events are in the log before they are needed, are cheap, and never hide the error that they report."""

import os
import pickle
from datetime import UTC, datetime, timedelta

import pytest

from moseg.schemas.errors import InputError, StoreError
from moseg.schemas.events import EventKind, PlanEvent, read_event, write_plan
from moseg.store import open_store
from moseg.workflows.runlog import events
from moseg.workflows.runlog.events import (
    EventLog,
    as_unicode,
    describe_error,
    is_written,
    new_run_id,
    note_written,
    this_process,
    work_event,
)

REFS = [f"flow/{digit * 64}" for digit in "0123"]


class _Store:
    """Store that records appends, or raises an error on them."""

    def __init__(self, error=None):
        self.appends = []
        self._error = error

    def append_log(self, run_id, lines):
        if self._error is not None:
            raise self._error
        self.appends.append(lines)


def _refs(lines):
    return [read_event(line).ref for line in lines.splitlines()]


@pytest.fixture
def clock(monkeypatch):
    """Return a clock that stands still until a test advances it."""

    class Clock:
        now = 0.0

        def perf_counter(self):
            return self.now

    clock = Clock()
    monkeypatch.setattr(events, "time", clock)
    return clock


def test_on_a_fast_store_every_event_is_written_at_once(clock):
    store = _Store()
    with EventLog(store, "run") as log:
        for number, ref in enumerate(REFS, start=1):
            log.add(work_event(EventKind.COMMITTED, ref))
            assert len(store.appends) == number


def test_appends_take_a_hundredth_of_the_time_beside_the_first_and_the_last(clock):
    class Slow(_Store):
        def append_log(self, run_id, lines):
            super().append_log(run_id, lines)
            clock.now += 0.03

    store = Slow()
    num_events, seconds = 1000, 0.1
    with EventLog(store, "run") as log:
        for _ in range(num_events):
            log.add(work_event(EventKind.COMMITTED, REFS[0]))
            clock.now += seconds
    between = len(store.appends) - 2
    assert 0 < between * 0.03 <= 0.01 * num_events * seconds
    assert sum(len(_refs(lines)) for lines in store.appends) == num_events


def _log_late(store, error=None):
    """Add an event that waits until the block ends, by an error or without one."""
    with EventLog(store, "run") as log:
        log._next_append = float("inf")
        log.add(work_event(EventKind.COMMITTED, REFS[0]))
        assert store.appends == []
        if error is not None:
            raise error


def test_waiting_lines_are_written_when_the_block_ends():
    store = _Store()
    _log_late(store)
    assert [_refs(lines) for lines in store.appends] == [[REFS[0]]]


def test_waiting_lines_are_written_when_the_block_fails():
    store, error = _Store(), ValueError("broken")
    with pytest.raises(ValueError, match="broken"):
        _log_late(store, error)
    assert [_refs(lines) for lines in store.appends] == [[REFS[0]]]


def test_a_failed_append_is_raised_unless_it_would_hide_another_error():
    full = StoreError("cannot write a run's log: no space left")
    with pytest.raises(StoreError, match="a run's log"):
        _log_late(_Store(full))
    with pytest.raises(StoreError, match="artifact store"):
        _log_late(_Store(full), StoreError("cannot write to the artifact store: no space left"))


def test_without_a_run_nothing_is_written():
    store = _Store(AssertionError("written"))
    with EventLog(store, None) as log:
        log.write([work_event(EventKind.STARTED, REFS[0])])
        log.add(work_event(EventKind.COMMITTED, REFS[0]))
        log.write_lines([b"line\n"])


def test_a_long_plan_is_written_in_few_appends_of_bounded_size(tmp_path):
    store = open_store(str(tmp_path / "store"))
    sizes, append = [], store.append_log

    def count(run_id, lines):
        sizes.append(len(lines))
        append(run_id, lines)

    store.append_log = count
    refs = [f"flow/{number:064x}" for number in range(100_000)]
    sample = PlanEvent(event=EventKind.PLANNED, ref=refs[0], time=this_process()["time"])
    EventLog(store, "run").write_lines(write_plan(sample, refs))
    assert max(sizes) < events.MAX_APPEND_BYTES + 1000
    assert len(sizes) == -(-sum(sizes) // events.MAX_APPEND_BYTES)
    lines = store.read_log("run")
    assert [read_event(lines[number]).ref for number in (0, -1)] == [refs[0], refs[-1]]
    assert len(lines) == len(refs)


def test_names_of_runs_differ_and_sort_as_the_runs_began(monkeypatch):
    class Clock(datetime):
        @classmethod
        def now(cls, zone):
            return moment

    monkeypatch.setattr(events, "datetime", Clock)
    names = []
    for milliseconds in range(0, 3000, 7):
        moment = datetime(2026, 11, 22, 0, 43, 18, tzinfo=UTC) + timedelta(milliseconds=milliseconds)
        names.append(new_run_id())
    assert names == sorted(names) and len({new_run_id() for _ in range(20)}) == 20
    assert names[0].startswith("20261122T004318-000") and names[-1].startswith("20261122T004320-")


@pytest.mark.parametrize("error", [ValueError("broken"), InputError("no such frame", where="a.png")])
def test_the_note_that_an_error_is_logged_is_pickled_with_it(error):
    assert not is_written(error)
    note_written(error, REFS[0])
    assert is_written(pickle.loads(pickle.dumps(error)))


def test_an_error_is_described_in_one_line_of_bounded_length():
    assert describe_error(ValueError("one\n  two")) == "ValueError: one two"
    assert describe_error(KeyboardInterrupt()) == "KeyboardInterrupt"
    assert describe_error(InputError("no such frame", where="a.png")) == "no such frame in a.png"
    assert len(describe_error(ValueError("x" * 10_000))) == events.MAX_MESSAGE


def test_arguments_of_another_encoding_are_written_legibly():
    name = os.fsdecode(b"latin-\xfc")
    assert as_unicode(name) == "latin-\\udcfc"
    assert describe_error(ValueError(name)) == "ValueError: latin-\\udcfc"
