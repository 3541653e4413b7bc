"""A line of a run's log says one thing, is read back as it was written, and keeps its form."""

import json
from datetime import UTC, datetime, timedelta

import pytest
from pydantic import ValidationError

from moseg.schemas.events import (
    DegenerateEvent,
    EventKind,
    Outcome,
    PlanEvent,
    RunClosed,
    RunOpened,
    SequenceSubject,
    SubjectEvent,
    TroubleEvent,
    VideoFrames,
    WorkEvent,
    line_time,
    read_event,
    write_event,
    write_plan,
)

REF = f"flow/{'ab' * 32}"
TIME = datetime(2026, 11, 22, 0, 43, 18, 123456, tzinfo=UTC)
PROCESS = {"time": TIME, "host": "node7", "pid": 4312}
WHERE = '"time":"2026-11-22T00:43:18.123456Z","host":"node7","pid":4312'

LINES = {
    EventKind.OPENED: (
        RunOpened(
            run_id="20261122T004318-3fa9c2",
            space="0" * 16,
            command=("moseg", "eval"),
            folder="/home/me",
            version="0.1.0",
            num_workers=2,
            **PROCESS,
        ),
        f'{{{WHERE},"event":"opened","run_id":"20261122T004318-3fa9c2","space":"0000000000000000",'
        '"command":["moseg","eval"],"folder":"/home/me","version":"0.1.0","num_workers":2}',
    ),
    EventKind.SUBJECT: (
        SubjectEvent(
            command="eval",
            dataset="folder",
            variants=("fused",),
            config={"max_side": 640, "detections": {"tags": None}},
            sequences=(SequenceSubject(leaves={"name": "dog", "frames": [REF], "void": None}, fps=24.0),),
            **PROCESS,
        ),
        f'{{{WHERE},"event":"subject","command":"eval","dataset":"folder","variants":["fused"],'
        '"config":{"max_side":640,"detections":{"tags":null}},"notes":[],'
        f'"sequences":[{{"leaves":{{"name":"dog","frames":["{REF}"],"void":null}},"fps":24.0}}]}}',
    ),
    EventKind.PLANNED: (
        PlanEvent(event=EventKind.PLANNED, time=TIME, ref=REF),
        f'{{"time":"2026-11-22T00:43:18.123456Z","event":"planned","ref":"{REF}"}}',
    ),
    EventKind.HIT: (
        PlanEvent(event=EventKind.HIT, time=TIME, ref=REF),
        f'{{"time":"2026-11-22T00:43:18.123456Z","event":"hit","ref":"{REF}"}}',
    ),
    EventKind.STARTED: (
        WorkEvent(event=EventKind.STARTED, ref=REF, **PROCESS),
        f'{{{WHERE},"event":"started","ref":"{REF}"}}',
    ),
    EventKind.COMPUTED: (
        WorkEvent(event=EventKind.COMPUTED, ref=REF, seconds=0.25, **PROCESS),
        f'{{{WHERE},"event":"computed","ref":"{REF}","seconds":0.25}}',
    ),
    EventKind.COMMITTED: (
        WorkEvent(event=EventKind.COMMITTED, ref=REF, **PROCESS),
        f'{{{WHERE},"event":"committed","ref":"{REF}"}}',
    ),
    EventKind.LOST_RACE: (
        WorkEvent(event=EventKind.LOST_RACE, ref=REF, **PROCESS),
        f'{{{WHERE},"event":"lost-race","ref":"{REF}"}}',
    ),
    EventKind.DEGENERATE: (
        DegenerateEvent(ref=REF, num_invalid=3, num_fits=8, reasons={"too-few-points": 3}, **PROCESS),
        f'{{{WHERE},"event":"degenerate","ref":"{REF}","num_invalid":3,"num_fits":8,"reasons":{{"too-few-points":3}}}}',
    ),
    EventKind.FAILED: (
        TroubleEvent(event=EventKind.FAILED, ref=REF, message="ValueError: no", **PROCESS),
        f'{{{WHERE},"event":"failed","ref":"{REF}","message":"ValueError: no"}}',
    ),
    EventKind.QUARANTINED: (
        TroubleEvent(event=EventKind.QUARANTINED, ref=REF, message="bad chunk", **PROCESS),
        f'{{{WHERE},"event":"quarantined","ref":"{REF}","message":"bad chunk"}}',
    ),
    EventKind.CLOSED: (
        RunClosed(outcome=Outcome.FINISHED, pins=("1a2b",), **PROCESS),
        f'{{{WHERE},"event":"closed","outcome":"finished","pins":["1a2b"]}}',
    ),
}


@pytest.mark.parametrize(
    ("frames", "line"),
    [
        (VideoFrames(numbers=(3, 5), part="2 frames, 3 to 5"), '{"numbers":[3,5],"part":"2 frames, 3 to 5"}'),
        (VideoFrames(names=("a.png", "b.png")), '{"names":["a.png","b.png"]}'),
        (VideoFrames(), "{}"),
    ],
)
def test_the_frames_of_a_video_are_in_the_line_of_its_run(frames, line):
    subject = LINES[EventKind.SUBJECT][0].model_copy(update={"video_frames": frames})
    assert f'"video_frames":{line}' in write_event(subject).decode()
    assert read_event(write_event(subject)) == subject


def test_every_kind_of_event_has_its_line():
    assert set(LINES) == set(EventKind)


@pytest.mark.parametrize("kind", EventKind)
def test_a_line_keeps_its_form_and_is_read_back(kind):
    event, line = LINES[kind]
    assert event.event == kind
    assert write_event(event) == line.encode() + b"\n"
    assert read_event(write_event(event)) == event


def test_lines_sort_by_their_times():
    sample, _ = LINES[EventKind.PLANNED]
    times = [TIME.replace(microsecond=0) + timedelta(milliseconds=step) for step in (0, 1, 10, 999, 1000, 60_000)]
    lines = [write_event(sample.model_copy(update={"time": time})) for time in times]
    late_first = lines[::-1]
    assert sorted(late_first, key=line_time) == lines
    assert all(line_time(line.encode()) == b"2026-11-22T00:43:18.123456" for _, line in LINES.values())


def test_a_message_of_several_lines_stays_one_line():
    event = TroubleEvent(event=EventKind.FAILED, message="one\ntwo\u2028three", **PROCESS)
    assert write_event(event).splitlines() == [write_event(event).rstrip(b"\n")]
    assert read_event(write_event(event)) == event


def test_the_lines_of_a_plan_are_those_of_its_events():
    refs = [f"{stage}/{digit * 64}" for stage in ("flow", "saliency") for digit in "0a"]
    sample, _ = LINES[EventKind.PLANNED]
    lines = [write_event(sample.model_copy(update={"ref": ref})) for ref in refs]
    assert list(write_plan(sample, refs)) == lines


@pytest.mark.parametrize(
    "change",
    [
        {"event": "begun"},
        {"event": None},
        {"ref": "flow/short"},
        {"time": "2026-11-22T00:43:18"},
        {"colour": "red"},
        {"seconds": "NaN"},
    ],
)
def test_what_is_no_event_is_refused(change):
    fields = json.loads(LINES[EventKind.COMPUTED][1]) | change
    with pytest.raises(ValidationError):
        read_event(json.dumps(fields).encode())
