"""A run's log holds what happened to every artifact, even if the run was killed."""

import json
import shutil
import signal
import subprocess
import sys
from collections import Counter
from contextlib import closing

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.events import EventKind
from moseg.schemas.recipes import Recipe, split_ref
from moseg.store import PutOutcome, open_store
from moseg.workflows.cluster.runners import SynchronousRunner
from moseg.workflows.datasets import open_dataset
from moseg.workflows.engine import execution
from moseg.workflows.engine.execution import execute_batches
from moseg.workflows.engine.session import Session
from moseg.workflows.pipelines.evaluate import evaluate
from moseg.workflows.runlog import run_log
from moseg.workflows.runlog.run_log import RunLog
from moseg.workflows.runlog.status import RunState, list_runs, read_events, read_status
from moseg.workflows.stages.task import Output, Task

CONFIG = PipelineConfig.model_validate({"sections": {"length": 4, "overlap": 2}})
LEAVES = {"frame", "annotation", "motion_weights"}
COMPUTED = [EventKind.PLANNED, EventKind.STARTED, EventKind.COMPUTED, EventKind.COMMITTED]

DIES_AT = """
import os, signal, sys
from moseg.workflows.engine import execution
from moseg.workflows.cli.app import run

compute = execution._execute_batch

def die(store, recipes, log):
    if recipes[0].task == sys.argv[1]:
        os.kill(os.getpid(), signal.SIGKILL)
    return compute(store, recipes, log)

execution._execute_batch = die
run(sys.argv[2:])
"""


def _open(folder):
    return open_store(str(folder), create=False)


def _events(store):
    """Return the events of the run that began last."""
    return list(read_events(store, list_runs(store)[0]))


def _kinds(events):
    """Return the events of each artifact, in order, without invalid fits and the run's own lines."""
    kinds = {}
    for event in events:
        if getattr(event, "ref", None) is not None and event.event != EventKind.DEGENERATE:
            kinds.setdefault(event.ref, []).append(event.event)
    return kinds


def _drop(store, *tasks):
    dropped = [ref for task in tasks for ref in store.refs(task)]
    for ref in dropped:
        store.remove(ref)
    return dropped


def _rerun(evaluation, runner=None, quiet=True):
    """Evaluate the squares again in this process."""
    data = open_dataset("folder", str(evaluation.root), max_side=CONFIG.max_side)
    store = _open(evaluation.store)
    with closing(Session(store, runner or SynchronousRunner(), quiet=quiet)) as session:
        evaluate(session, data.name, [data.sequence("squares")], CONFIG, [Variant.FUSED])
    return session


def test_every_artifact_of_a_run_is_planned_started_computed_and_committed(evaluated):
    store = _open(evaluated.store)
    events = _events(store)
    kinds = _kinds(events)
    assert set(kinds) == {ref for ref in store.refs() if split_ref(ref)[0] not in LEAVES}
    assert all(kind == COMPUTED for kind in kinds.values())
    assert (events[0].event, events[-1].event) == (EventKind.OPENED, EventKind.CLOSED)
    assert events[-1].outcome == "finished"
    assert set(events[-1].pins) == set(store.pinned())
    measured = {event.ref: event.seconds for event in events if event.event == EventKind.COMPUTED}
    assert measured["score/" + split_ref(next(store.refs("score")))[1]] > 0
    assert {ref: store.manifest(ref).seconds for ref in measured if not ref.startswith("ingest/")} == {
        ref: seconds for ref, seconds in measured.items() if not ref.startswith("ingest/")
    }


def test_workers_write_their_own_parts_of_the_same_log(evaluated, evaluated_by_workers):
    events = _events(_open(evaluated_by_workers.store))
    assert {ref: Counter(kinds) for ref, kinds in _kinds(events).items()} == {
        ref: Counter(kinds) for ref, kinds in _kinds(_events(_open(evaluated.store))).items()
    }
    client = events[0].pid
    assert events[0].num_workers == 2
    workers = {event.pid for event in events if event.event == EventKind.STARTED}
    # The first worker that is ready may have computed everything.
    assert len(workers) in (1, 2) and client not in workers


def test_a_log_holds_the_artifacts_that_a_run_reuses(evaluated_copy):
    store = _open(evaluated_copy.store)
    dropped = _drop(store, "segmentation", "score")
    session = _rerun(evaluated_copy)
    kinds = _kinds(_events(store))
    assert list_runs(store)[0] == session.run_id
    assert {ref for ref, found in kinds.items() if found == COMPUTED} == set(dropped)
    hits = [ref for ref, found in kinds.items() if found == [EventKind.HIT]]
    assert len(hits) == session.reused.total() > 0
    assert len(hits) + len(dropped) == len(kinds)


def test_a_run_that_computes_nothing_leaves_no_log(evaluated_copy):
    store = _open(evaluated_copy.store)
    before = store.logs()
    assert _rerun(evaluated_copy).computed.total() == 0
    assert store.logs() == before


def test_without_write_access_for_logs_a_store_can_be_read_only(evaluated_copy, moseg):
    shutil.rmtree(evaluated_copy.store / "logs")
    (evaluated_copy.store / "logs").write_text("")
    arguments = (*evaluated_copy.arguments, "--store", evaluated_copy.store)
    ran = moseg(*arguments)
    assert (ran.code, ran.err) == (0, "")
    ran = moseg(*arguments, "--set", "affinity.scale=0.8")
    assert ran.code == 1
    (line,) = ran.err.splitlines()
    assert line.startswith("moseg: cannot write") and "log" in line


class _StoresFirst(SynchronousRunner):
    """Runner before whose first call another run stores one of the artifacts."""

    def __init__(self, store, recipe, attributes):
        self._put = lambda: store.put(recipe, {}, attributes)

    def run(self, calls, on_done):
        if calls:
            self._put()
        super().run(calls, on_done)


def test_an_artifact_that_another_run_stores_first_is_a_lost_race(evaluated_copy):
    store = _open(evaluated_copy.store)
    (ref,) = store.refs("score")
    recipe, attributes = store.manifest(ref).recipe, store.attributes(ref)
    store.remove(ref)
    _rerun(evaluated_copy, _StoresFirst(store, recipe, attributes))
    assert _kinds(_events(store))[ref] == [EventKind.PLANNED, EventKind.STARTED, EventKind.LOST_RACE]


@pytest.fixture
def execute(tmp_path, monkeypatch):
    """Return a function that executes recipes by a function of the store and returns the run's events and error."""
    store = open_store(str(tmp_path / "store"))

    def call(recipes, run):
        task = Task("score", "stub", version=1, run=lambda params, inputs, rng: run(store))
        monkeypatch.setattr(execution, "find_task", lambda *_: task)
        error = None
        try:
            execute_batches(store.url, [[recipe] for recipe in recipes], "run")
        except Exception as raised:
            error = raised
        return list(read_events(store, "run")), error

    return call


RECIPE = Recipe(task="score", version=1, params={"method": "stub"})


def test_an_artifact_that_another_run_stores_meanwhile_is_computed_and_a_lost_race(execute):
    def run(store):
        assert store.put(RECIPE, {}, {}) == PutOutcome.COMMITTED
        return Output({}, {})

    events, _ = execute([RECIPE], run)
    assert _kinds(events)[RECIPE.ref] == [EventKind.STARTED, EventKind.COMPUTED, EventKind.LOST_RACE]


def test_a_failure_is_logged_for_the_failed_artifact_only(execute):
    other = Recipe(task="score", version=2, params={"method": "stub"})
    outputs = [Output({}, {})]
    events, error = execute([RECIPE, other], lambda store: outputs.pop())
    assert isinstance(error, IndexError)
    kinds = _kinds(events)
    assert kinds[RECIPE.ref] == [EventKind.STARTED, EventKind.COMPUTED, EventKind.COMMITTED]
    assert kinds[other.ref] == [EventKind.STARTED, EventKind.FAILED]
    (failed,) = (event for event in events if event.event == EventKind.FAILED)
    assert failed.message == "IndexError: pop from empty list"
    assert [other.ref in note for note in error.__notes__] == [True]


def test_invalid_fits_are_logged(execute):
    def run(store):
        return Output(
            {"valid": np.array([[True, False]]), "theta": np.zeros((1, 2, 4)), "moments": np.zeros((1, 2, 3))}
        )

    recipe = Recipe(task="flow_model", version=1, params={"method": "stub"})
    events, _ = execute([recipe], run)
    assert [event.event for event in events] == [
        EventKind.STARTED,
        EventKind.COMPUTED,
        EventKind.DEGENERATE,
        EventKind.COMMITTED,
    ]
    assert (events[2].num_invalid, events[2].num_fits) == (1, 2)


def test_a_scene_without_texture_is_logged_as_degenerate(moseg, write_image, tmp_path):
    masks = np.zeros((48, 64), np.uint8)
    masks[10:20, 10:20] = 1
    for number in range(4):
        write_image(tmp_path / "data" / "flat" / "frames" / f"{number:05d}.png", np.full((48, 64, 3), 128, np.uint8))
        write_image(tmp_path / "data" / "flat" / "masks" / f"{number:05d}.png", masks)
    arguments = ("eval", "--dataset", "folder", "--root", tmp_path / "data", "--proposals", "groundtruth")
    ran = moseg(*arguments, "--store", tmp_path / "store", "--quiet")
    assert ran.code == 0, ran.err
    found = [event for event in _events(_open(tmp_path / "store")) if event.event == EventKind.DEGENERATE]
    fits = [event for event in found if event.stage == "fundamental"]
    assert fits and all(event.num_invalid == event.num_fits for event in fits)
    assert all(event.reasons == {"too-few-points": event.num_fits} for event in fits)


def test_a_task_that_raises_ends_the_run_and_its_log(evaluated_copy, moseg, monkeypatch):
    store = _open(evaluated_copy.store)
    (ref,) = _drop(store, "score")

    def fail(params, inputs, rng):
        raise RuntimeError("broken")

    monkeypatch.setattr(execution, "find_task", lambda name, method: Task(name, method, version=1, run=fail))
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store)
    assert ran.code == 1
    assert ran.err.splitlines()[-1] == "moseg: a fault, not your input: RuntimeError: broken"
    assert f"while computing {ref}" in ran.err
    events = _events(store)
    assert _kinds(events)[ref] == [EventKind.PLANNED, EventKind.STARTED, EventKind.FAILED]
    # The process in which it occurred has logged it; the client does not do so again.
    assert [event.message for event in events if event.event == EventKind.FAILED] == ["RuntimeError: broken"]
    assert (events[-1].outcome, events[-1].message) == ("failed", "RuntimeError: broken")


@pytest.mark.parametrize(
    ("error", "outcome", "messages"),
    [
        (RuntimeError("no worker left"), "failed", ["RuntimeError: no worker left"]),
        (KeyboardInterrupt(), "interrupted", []),
    ],
)
def test_a_failure_of_the_client_is_logged_by_the_client(evaluated_copy, error, outcome, messages):
    class Fails(SynchronousRunner):
        def run(self, calls, on_done):
            if calls:
                raise error

    store = _open(evaluated_copy.store)
    _drop(store, "score")
    with pytest.raises(type(error)):
        _rerun(evaluated_copy, Fails())
    events = _events(store)
    assert [event.message for event in events if event.event == EventKind.FAILED] == messages
    assert (events[-1].event, events[-1].outcome) == (EventKind.CLOSED, outcome)


def test_only_a_damaged_artifact_is_planned_again(evaluated_copy):
    store = _open(evaluated_copy.store)
    _drop(store, "score", "segmentation", "clustering")
    ref = next(store.refs("affinity"))
    task, key = split_ref(ref)
    (evaluated_copy.store / "objects" / task / key[:2] / key / "manifest.json").write_text("{")
    _rerun(evaluated_copy)
    events = _events(store)
    kinds = _kinds(events)
    assert kinds[ref] == [EventKind.HIT, EventKind.QUARANTINED, *COMPUTED]
    assert [event.ref for event in events if event.event == EventKind.QUARANTINED] == [ref]
    assert max(Counter(found)[EventKind.PLANNED] for found in kinds.values()) == 1
    assert EventKind.FAILED not in {event.event for event in events}
    assert read_status(store, list_runs(store)[0]).num_done == sum(COMPUTED[0] in found for found in kinds.values())


def test_the_log_of_a_killed_run_shows_its_unfinished_artifacts(evaluated, tmp_path):
    command = [sys.executable, "-c", DIES_AT, "consistency", *evaluated.arguments, "--store", str(tmp_path / "store")]
    assert subprocess.run(command, check=False).returncode == -signal.SIGKILL
    store = _open(tmp_path / "store")
    status = read_status(store, list_runs(store)[0])
    assert status.state == RunState.DEAD
    (work,) = status.in_flight
    assert split_ref(work.ref)[0] == "consistency"
    # Stored artifacts are in the log, except those of the last moment.
    logged = {event.ref for event in _events(store) if event.event == EventKind.COMMITTED}
    stored = {ref for ref in store.refs() if split_ref(ref)[0] not in LEAVES}
    assert logged and logged <= stored


def test_a_run_that_computes_prints_once_how_to_follow_it(evaluated_copy, capsys):
    _rerun(evaluated_copy, quiet=False)
    assert capsys.readouterr().err == ""
    store = _open(evaluated_copy.store)
    _drop(store, "score")
    session = _rerun(evaluated_copy, quiet=False)
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("run ")]
    assert lines == [f"run {session.run_id} (moseg status {session.run_id} --store {evaluated_copy.store})"]
    _drop(store, "score")
    _rerun(evaluated_copy)
    assert capsys.readouterr().err == ""


def test_bad_input_is_reported_in_one_line_and_in_the_log(squares, moseg, write_image, tmp_path):
    folder = tmp_path / "data" / "one" / "frames"
    folder.mkdir(parents=True)
    shutil.copy(sorted((squares / "squares" / "frames").iterdir())[0], folder)
    shutil.copytree(squares / "squares" / "masks", folder.parent / "masks")
    for path in sorted((folder.parent / "masks").iterdir())[1:]:
        path.unlink()
    ran = moseg("eval", "--dataset", "folder", "--root", tmp_path / "data", "--store", tmp_path / "store", "--quiet")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    events = _events(_open(tmp_path / "store"))
    assert (events[-1].outcome, f"moseg: {events[-1].message}") == ("failed", line)
    assert json.loads(events[-1].model_dump_json())["message"].startswith("too few frames")


def test_a_long_session_remembers_only_its_last_plans_and_counts_each_artifact_once(tmp_path, monkeypatch):
    monkeypatch.setattr(run_log, "MAX_REMEMBERED", 10)
    store = open_store(str(tmp_path), create=True)
    log = RunLog(store, "20260101T000000-0123456789abcdef", quiet=True)
    log.open(lambda: 1)
    refs = [f"affinity/{number:064x}" for number in range(40)]
    for ref in refs:
        log.plan([ref])
    log.plan(refs[:1])
    log.close()
    assert len(log._written) == 10
    (run_id,) = list_runs(store)
    assert len([event for event in read_events(store, run_id) if event.event == EventKind.PLANNED]) == 41
    assert read_status(store, run_id).num_planned == 40
