"""`moseg status` shows the state of a run: while it is active, after it ended, and after it died."""

import json
import os
import time
from datetime import UTC, datetime, timedelta

import pytest

from moseg.schemas.errors import InputError, StoreError
from moseg.schemas.events import (
    DegenerateEvent,
    EventKind,
    Outcome,
    PlanEvent,
    RunClosed,
    RunOpened,
    TroubleEvent,
    WorkEvent,
    write_event,
)
from moseg.store import open_store
from moseg.store.owners import process_space
from moseg.workflows.cli import status as command
from moseg.workflows.runlog.status import RunState, find_run, list_runs, old_logs, read_status, summarise

START = datetime(2026, 11, 22, tzinfo=UTC)
RUN = "20261122T000000-aaaaaa"
NO_PROCESS = 2**22 + 1
"""Above the largest number that Linux gives to a process."""


def _at(seconds):
    return START + timedelta(seconds=seconds)


def _ref(number, stage="flow"):
    return f"{stage}/{number:064x}"


def _opened(pid=None, space=None, seconds=0.0):
    return RunOpened(
        time=_at(seconds),
        host="node7",
        pid=pid or os.getpid(),
        run_id=RUN,
        space=space or process_space(),
        command=("moseg", "eval"),
        folder="/home/me",
        version="0.1.0",
        num_workers=2,
    )


def _planned(*refs, seconds=0.0, kind=EventKind.PLANNED):
    return [PlanEvent(event=kind, time=_at(seconds), ref=ref) for ref in refs]


def _work(kind, ref, at, pid=1, seconds=None):
    return WorkEvent(event=kind, time=_at(at), host="node7", pid=pid, ref=ref, seconds=seconds)


def _computed(ref, begin, end, pid=1, seconds=None):
    steps = [_work(EventKind.STARTED, ref, begin, pid)]
    steps.append(_work(EventKind.COMPUTED, ref, end, pid, seconds=seconds or end - begin))
    return [*steps, _work(EventKind.COMMITTED, ref, end, pid)]


def _closed(outcome, seconds, message=None):
    return RunClosed(time=_at(seconds), host="node7", pid=1, outcome=outcome, message=message)


def _trouble(kind, ref, message, seconds=1.0):
    return TroubleEvent(event=kind, time=_at(seconds), host="node7", pid=1, ref=ref, message=message)


def _summary(*events, now=10.0):
    return summarise(RUN, sorted(events, key=lambda event: event.time), _at(now))


@pytest.mark.parametrize("outcome", Outcome)
def test_a_closed_run_has_the_state_that_it_logged(outcome):
    status = _summary(_opened(NO_PROCESS), _closed(outcome, 4.0, "why"))
    assert (status.state.value, status.seconds, status.message) == (outcome.value, 4.0, "why")
    assert status.rest_seconds is None


def test_a_run_that_did_not_close_runs_as_long_as_its_process_does():
    events = _planned(_ref(1), seconds=3.0)
    running, dead = _summary(_opened(), *events), _summary(_opened(NO_PROCESS), *events)
    assert (running.state, running.seconds, running.ended) == (RunState.RUNNING, 10.0, None)
    assert (dead.state, dead.seconds, dead.ended) == (RunState.DEAD, 3.0, _at(3.0))
    assert running.is_asked and dead.is_asked


def test_a_process_that_cannot_be_checked_counts_as_running_with_a_mark():
    status = _summary(_opened(NO_PROCESS, space="0" * 16))
    assert (status.state, status.is_asked) == (RunState.RUNNING, False)


def test_artifacts_are_counted_by_stage_and_kind():
    status = _summary(
        _opened(),
        *_planned(_ref(1), _ref(2), _ref(3), _ref(4), _ref(5, "score")),
        *_planned(_ref(6), _ref(7, "tracks"), kind=EventKind.HIT),
        *_computed(_ref(1), 1.0, 3.0),
        DegenerateEvent(
            time=_at(3.0), host="node7", pid=1, ref=_ref(1), num_invalid=2, num_fits=6, reasons={"collinear": 2}
        ),
        _work(EventKind.STARTED, _ref(2), 3.0),
        _work(EventKind.LOST_RACE, _ref(2), 4.0),
        _work(EventKind.STARTED, _ref(3), 4.0),
        _trouble(EventKind.FAILED, _ref(3), "broken", 5.0),
    )
    flow, score, tracks = status.stages
    assert (flow.stage, flow.planned, flow.done, flow.hits) == ("flow", 4, 2, 1)
    assert (flow.computed, flow.committed, flow.lost_races, flow.failed, flow.seconds) == (1, 1, 1, 1, 2.0)
    assert (flow.degenerate, flow.invalid_fits, flow.fits, flow.reasons) == (1, 2, 6, {"collinear": 2})
    assert (score.stage, score.planned, score.done) == ("score", 1, 0)
    assert (tracks.stage, tracks.planned, tracks.hits) == ("tracks", 0, 1)
    assert (status.num_done, status.num_planned, status.num_failed) == (2, 5, 1)
    assert [(trouble.ref, trouble.message) for trouble in status.failures] == [(_ref(3), "broken")]


def test_an_artifact_stored_before_its_plan_by_another_clock_is_done():
    status = _summary(_opened(), *_computed(_ref(1), 1.0, 2.0), *_planned(_ref(1), _ref(2), seconds=3.0))
    assert (status.num_done, status.num_planned, status.stages[0].done) == (1, 2, 1)


def test_a_repaired_artifact_is_counted_once_and_is_no_hit():
    status = _summary(
        _opened(),
        *_planned(_ref(1)),
        *_computed(_ref(1), 1.0, 2.0),
        _trouble(EventKind.QUARANTINED, _ref(1), "bad chunk", 3.0),
        *_planned(_ref(1), seconds=4.0),
        *_planned(_ref(1), seconds=9.0, kind=EventKind.HIT),
    )
    assert (status.num_planned, status.num_done) == (1, 0)
    assert status.stages[0].hits == 0
    assert [trouble.message for trouble in status.quarantined] == ["bad chunk"]


def test_started_and_unfinished_artifacts_are_running():
    begun = [_work(EventKind.STARTED, _ref(number), 1.0, pid=1) for number in (1, 2, 3)]
    done = [_work(EventKind.COMPUTED, _ref(1), 4.0, seconds=3.0), _work(EventKind.COMMITTED, _ref(1), 4.0)]
    status = _summary(_opened(), *begun, *done, _work(EventKind.STARTED, _ref(9), 2.0, pid=5))
    assert [(work.pid, work.ref, work.since, work.num_behind) for work in status.in_flight] == [
        (1, _ref(2), _at(4.0), 1),
        (5, _ref(9), _at(2.0), 0),
    ]


def test_an_artifact_restarted_by_another_worker_is_running_there():
    lost, again = _work(EventKind.STARTED, _ref(1), 1.0, pid=1), _work(EventKind.STARTED, _ref(1), 5.0, pid=2)
    assert [work.pid for work in _summary(_opened(), lost, again).in_flight] == [2]


def test_the_remaining_time_follows_from_the_seconds_of_each_stage_and_the_pace():
    refs = [_ref(number) for number in range(4)]
    scores = [_ref(number, "score") for number in range(2)]
    # Two workers, both always busy: ten seconds of computation take five.
    done = [*_computed(refs[0], 0.0, 4.0, pid=1), *_computed(refs[1], 0.0, 4.0, pid=2)]
    done += [*_computed(scores[0], 4.0, 5.0, pid=1), *_computed(_ref(9, "tracks"), 4.0, 5.0, pid=2)]
    status = _summary(_opened(), *_planned(*refs, *scores, _ref(9, "tracks")), *done, now=5.0)
    assert status.rest_seconds == pytest.approx((2 * 4.0 + 1.0) / 2)


def test_no_remaining_time_is_estimated_without_a_basis():
    planned = _planned(_ref(1))
    assert _summary(_opened(), *planned).rest_seconds is None
    sources = _planned(_ref(1, "ingest"), _ref(2, "ingest"))
    assert _summary(_opened(), *sources, *_computed(_ref(1, "ingest"), 0.0, 1.0)).rest_seconds is None


@pytest.fixture
def logged(tmp_path):
    """Return a store, and a function that writes events to the log of a run in it."""
    store = open_store(str(tmp_path / "store"))

    def write(*events, run_id=RUN):
        store.append_log(run_id, b"".join(write_event(event) for event in events))

    return store, write


def test_lines_that_are_no_events_are_counted_as_unreadable(logged, moseg):
    store, write = logged
    write(_opened(NO_PROCESS), *_planned(_ref(1), _ref(2)))
    assert "unreadable" not in moseg("status", RUN, "--store", store.url).out
    store.append_log(RUN, b'{"event":"dreamt"}\n\n{"time":"2026-11-22T00:00:01Z","ho\n')
    write(*_computed(_ref(1), 0.0, 1.0))
    status = read_status(store, RUN)
    assert (status.num_done, status.num_planned, status.num_unreadable) == (1, 2, 3)
    ran = moseg("status", RUN, "--store", store.url)
    assert (ran.code, ran.err) == (0, "") and "unreadable: 3 lines" in ran.out


def test_a_log_without_a_beginning_hides_no_other_run(logged, moseg, tmp_path):
    store, write = logged
    write(_opened(NO_PROCESS))
    write(*_planned(_ref(1)), run_id="20261123T000000-bbbbbb")
    with pytest.raises(StoreError, match="20261123T000000-bbbbbb"):
        read_status(store, "20261123T000000-bbbbbb")
    ran = moseg("status", "--store", store.url, "--json", tmp_path / "runs.json")
    assert (ran.code, ran.err) == (0, "")
    lines = [line.split()[:2] for line in ran.out.splitlines() if line.startswith("2026")]
    assert lines == [[RUN, "dead"], ["20261123T000000-bbbbbb", "unreadable:"]]
    assert [run["run_id"] for run in json.loads((tmp_path / "runs.json").read_text())] == [RUN]
    ran = moseg("status", "latest", "--store", store.url)
    assert (ran.code, len(ran.err.splitlines())) == (1, 1)


def test_a_status_shows_state_counts_time_and_failures(logged, moseg):
    store, write = logged
    write(_opened(NO_PROCESS), *_planned(_ref(1), _ref(2), _ref(3)), *_planned(_ref(4, "tracks"), kind=EventKind.HIT))
    write(*_computed(_ref(1), 0.0, 2.0), _work(EventKind.STARTED, _ref(2), 2.0))
    write(_trouble(EventKind.QUARANTINED, _ref(3), "bad chunk"), _trouble(EventKind.FAILED, None, "no [worker] left"))
    ran = moseg("status", RUN, "--store", store.url)
    assert (ran.code, ran.err) == (0, "")
    for text in (RUN, "dead", "1 of 3 artifacts (33 %)", "moseg eval", "/home/me", "1/3"):
        assert text in ran.out
    assert f"was in flight: {_ref(2)[:15]} (process 1 of node7)" in ran.out
    assert "slowest: flow 2.0 s (100 %)" in ran.out
    assert "bad chunk" in ran.out and "failed: no [worker] left" in ran.out


def test_the_json_has_all_failures_and_the_terminal_the_first(logged, moseg, tmp_path):
    store, write = logged
    write(_opened(), *(_trouble(EventKind.FAILED, _ref(number), f"broken {number}") for number in range(30)))
    ran = moseg("status", RUN, "--store", store.url, "--json", tmp_path / "status.json")
    assert "broken 0" in ran.out and "broken 29" not in ran.out and "and 20 more" in ran.out
    found = json.loads((tmp_path / "status.json").read_text())
    assert [trouble["message"] for trouble in found["failures"]] == [f"broken {number}" for number in range(30)]


def test_runs_are_listed_the_latest_first(logged, moseg, tmp_path):
    store, write = logged
    ran = moseg("status", "--store", store.url)
    assert (ran.code, ran.err) == (0, "") and store.url in ran.out
    runs = [f"20261122T00000{number}-aaaaaa" for number in range(3)]
    for run_id in runs:
        write(_opened(NO_PROCESS), *_planned(_ref(1)), run_id=run_id)
    write(*_computed(_ref(1), 0.0, 1.0), _closed(Outcome.FINISHED, 2.0), run_id=runs[1])
    ran = moseg("status", "--store", store.url, "--last", "2", "--json", tmp_path / "runs.json")
    lines = [line for line in ran.out.splitlines() if line.startswith("2026")]
    assert [line.split()[:3] for line in lines] == [[runs[2], "dead", "0/1"], [runs[1], "finished", "1/1"]]
    assert "1 earlier" in ran.out
    assert [run["run_id"] for run in json.loads((tmp_path / "runs.json").read_text())] == [runs[2], runs[1]]


@pytest.mark.parametrize("name", [RUN, RUN[:10], "latest"])
def test_a_run_is_found_by_its_name_its_start_or_as_the_latest(logged, moseg, name):
    store, write = logged
    write(_opened())
    write(_opened(), run_id="20250101T000000-bbbbbb")
    assert RUN in moseg("status", name, "--store", store.url).out


@pytest.mark.parametrize(("name", "what"), [("2027", "no such run"), ("", "no such run"), ("202", "ambiguous run")])
def test_a_bad_name_of_a_run_is_one_line(logged, moseg, name, what):
    store, write = logged
    write(_opened())
    write(_opened(), run_id="20250101T000000-bbbbbb")
    ran = moseg("status", name, "--store", store.url)
    (line,) = ran.err.splitlines()
    assert ran.code == 2 and line.startswith(f"moseg: {what}")


def test_a_store_without_runs_or_no_store_is_one_line(logged, moseg, tmp_path):
    store, _ = logged
    for place in (store.url, tmp_path / "nowhere"):
        ran = moseg("status", "latest", "--store", place)
        assert (ran.code, len(ran.err.splitlines())) == (2, 1)


def test_following_shows_a_run_until_it_ends(logged, moseg, monkeypatch):
    store, write = logged
    write(_opened(), *_planned(_ref(1)))
    ends = [_computed(_ref(1), 0.0, 1.0), [_closed(Outcome.FINISHED, 2.0)]]
    monkeypatch.setattr(command.time, "sleep", lambda seconds: write(*ends.pop(0)))
    ran = moseg("status", "--follow", "--store", store.url)
    assert (ran.code, ends) == (0, [])
    assert "finished" in ran.out and "1 of 1 artifacts (100 %)" in ran.out


def test_stopping_to_follow_a_run_does_not_interrupt_it(logged, moseg, monkeypatch):
    def stop(seconds):
        raise KeyboardInterrupt

    store, write = logged
    write(_opened())
    monkeypatch.setattr(command.time, "sleep", stop)
    ran = moseg("status", "--follow", "--store", store.url)
    assert (ran.code, ran.err) == (0, "")
    assert "running" in ran.out


def test_logs_of_active_runs_are_not_old(logged):
    store, write = logged
    runs = [f"2026112{number}T000000-aaaaaa" for number in range(3)]
    for run_id in runs:
        write(_opened(NO_PROCESS), run_id=run_id)
    assert old_logs(store, grace_seconds=60.0) == []
    before = time.time() - 120.0
    for run_id in runs[:2]:
        for path in (store.root / "logs" / run_id).iterdir():
            os.utime(path, (before, before))
    store.pin(runs[1], [], lease_seconds=60.0)
    assert old_logs(store, grace_seconds=60.0) == runs[:1]
    assert list_runs(store) == runs[::-1]


def test_logs_of_runs_whose_results_are_kept_stay(logged):
    store, write = logged
    for run_id, pins in {"kept": ("results",), "forgotten": ("others",)}.items():
        write(_opened(), _closed(Outcome.FINISHED, 1.0).model_copy(update={"pins": pins}), run_id=run_id)
        for path in (store.root / "logs" / run_id).iterdir():
            os.utime(path, (0, 0))
    store.pin("results", [])
    assert old_logs(store, grace_seconds=60.0) == ["forgotten"]
    store.unpin("results")
    assert old_logs(store, grace_seconds=60.0) == ["forgotten", "kept"]


def test_only_existing_runs_are_suggested(logged):
    store, write = logged
    for name in ("latest", "lates", RUN[:-1] + "x"):
        with pytest.raises(InputError) as raised:
            find_run(store, name)
        assert "did you mean" not in str(raised.value)
    write(_opened(), run_id=RUN)
    for name, meant in {"lates": "latest", RUN[:-1] + "x": RUN}.items():
        with pytest.raises(InputError, match=f"did you mean '{meant}'"):
            find_run(store, name)


def test_logs_of_runs_without_a_pin_stay_while_their_process_runs(logged):
    store, write = logged
    runs = {
        "running": [_opened()],
        "ended": [_opened(), _closed(Outcome.FINISHED, 1.0)],
        "elsewhere": [_opened(NO_PROCESS, space="0" * 16)],
        "headless": _planned(_ref(1)),
    }
    for run_id, events in runs.items():
        write(*events, run_id=run_id)
        for path in (store.root / "logs" / run_id).iterdir():
            os.utime(path, (0, 0))
    assert old_logs(store, grace_seconds=60.0) == ["elsewhere", "ended", "headless"]
