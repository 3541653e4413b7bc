"""The artifacts of a run stay in the store during the run and after it, however other runs end."""

import json
import shutil
import signal
import subprocess
import sys
import time
from contextlib import closing

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.recipes import split_ref
from moseg.store import open_store
from moseg.store.collection import STEP_SECONDS
from moseg.workflows.cluster.runners import SynchronousRunner
from moseg.workflows.datasets import open_dataset
from moseg.workflows.engine.run_pins import RENEWED_SECONDS, RunPins
from moseg.workflows.engine.session import Session
from moseg.workflows.pipelines.evaluate import evaluate

LEAVES = {"frame", "annotation", "motion_weights", "ingest"}
READ_FIRST = LEAVES | {"repetitions", "scene_parallax"}
"""References that a run reads before its graph is written."""
CONFIG = PipelineConfig.model_validate({"sections": {"length": 4, "overlap": 2}})

DIES_AT_WORK = """
import os, signal, sys
from moseg.workflows.cluster import runners
from moseg.workflows.cli.app import run

def die(self, calls, on_done):
    if calls:
        os.kill(os.getpid(), signal.SIGKILL)

runners.SynchronousRunner.run = die
run(sys.argv[1:])
"""


class _Fails(SynchronousRunner):
    def run(self, calls, on_done):
        if calls:
            raise RuntimeError("out of memory")


class _LooksOn(SynchronousRunner):
    """Runner that calls `look` when the first call arrives: the plan is then made, and pinned."""

    def __init__(self, look):
        self._look = look

    def run(self, calls, on_done):
        if calls:
            self._look()
        super().run(calls, on_done)


def _open(evaluation):
    return open_store(str(evaluation.store), create=False)


def _drop(store, *tasks):
    for ref in list(store.refs()):
        if split_ref(ref)[0] in tasks:
            store.remove(ref)


def _unpin_all(store):
    for run_id in store.pinned():
        store.unpin(run_id)


def _rerun(evaluation, runner):
    """Evaluate the squares again and return the computed artifacts of the session."""
    data = open_dataset("folder", str(evaluation.root), max_side=CONFIG.max_side)
    with closing(Session(_open(evaluation), runner, quiet=True)) as session:
        evaluate(session, data.name, [data.sequence("squares")], CONFIG, [Variant.FUSED])
    return session.computed.total()


def _finish(evaluation):
    assert _rerun(evaluation, SynchronousRunner()) > 0


def _fail(evaluation):
    with pytest.raises(RuntimeError, match="out of memory"):
        _rerun(evaluation, _Fails())


def _die(evaluation):
    command = [sys.executable, "-c", DIES_AT_WORK, *evaluation.arguments, "--store", str(evaluation.store)]
    assert subprocess.run(command, check=False).returncode == -signal.SIGKILL


def _collect(store):
    return store.gc(is_dry=False, grace_seconds=0).removed


@pytest.mark.parametrize("end", [_finish, _fail, _die])
def test_a_run_at_work_keeps_its_lease_however_a_run_of_the_same_work_ends(evaluated_copy, end):
    store = _open(evaluated_copy)
    _unpin_all(store)
    _drop(store, *({split_ref(ref)[0] for ref in store.refs()} - READ_FIRST))
    leaves = set(store.refs())
    removed = []

    def other_run_ends():
        (lease,) = store.pinned().values()
        assert lease.expires is not None
        assert leaves <= {*lease.refs}
        end(evaluated_copy)
        assert store.pinned()[lease.run_id] == lease
        # The pin of a finished run does not protect these.
        for run_id in store.pinned().keys() - {lease.run_id}:
            store.unpin(run_id)
        removed.extend(_collect(store))

    _rerun(evaluated_copy, _LooksOn(other_run_ends))
    assert removed == []
    assert leaves < set(store.refs())


def test_leaves_are_leased_while_the_sources_of_proposals_are_chosen(evaluated_copy):
    store = _open(evaluated_copy)
    _unpin_all(store)
    _drop(store, *({split_ref(ref)[0] for ref in store.refs()} - LEAVES - {"repetitions"}))
    leaves = set(store.refs())
    seen = []

    def look():
        if not seen:
            seen.extend(lease for lease in store.pinned().values() if lease.expires is not None)
            assert not _collect(store)

    _rerun(evaluated_copy, _LooksOn(look))
    (lease,) = seen
    assert leaves < {*lease.refs}
    assert {split_ref(ref)[0] for ref in {*lease.refs} - leaves} == {"scene_parallax"}


@pytest.mark.parametrize("end", [_fail, _die])
def test_a_rerun_that_fails_leaves_the_pin_of_the_finished_run(evaluated_copy, end):
    store = _open(evaluated_copy)
    before = store.pinned()
    assert before
    _drop(store, "score")
    end(evaluated_copy)
    assert store.pinned() == before


def test_a_finished_run_leaves_a_lasting_pin_and_no_lease(evaluated_copy):
    store = _open(evaluated_copy)
    _unpin_all(store)
    _drop(store, "score")
    _finish(evaluated_copy)
    (pin,) = store.pinned().values()
    assert pin.expires is None
    assert {*store.refs("score")} <= {*pin.refs}
    assert [path.stem for path in (evaluated_copy.store / "pins").iterdir()] == [pin.run_id]


def test_a_failed_run_leaves_no_lease(evaluated_copy):
    store = _open(evaluated_copy)
    _unpin_all(store)
    _drop(store, "score")
    _fail(evaluated_copy)
    assert list((evaluated_copy.store / "pins").iterdir()) == []


def test_a_warm_run_pins_what_it_reused(evaluated_copy):
    store = _open(evaluated_copy)
    _unpin_all(store)
    kept = set(store.refs())
    assert _rerun(evaluated_copy, SynchronousRunner()) == 0
    assert _collect(store) == ()
    assert set(store.refs()) == kept
    assert _rerun(evaluated_copy, SynchronousRunner()) == 0


def test_without_write_access_for_pins_a_store_can_be_read_only(evaluated_copy, moseg, tmp_path):
    shutil.rmtree(evaluated_copy.store / "pins")
    (evaluated_copy.store / "pins").write_text("")
    arguments = (*evaluated_copy.arguments, "--store", evaluated_copy.store)
    ran = moseg(*arguments, "--json", tmp_path / "again.json")
    assert (ran.code, ran.err) == (0, "")
    report = json.loads((tmp_path / "again.json").read_text())
    assert report["store"]["computed"] == 0
    assert report["rows"] == evaluated_copy.report["rows"]
    ran = moseg(*arguments, "--set", "affinity.scale=0.8")
    assert ran.code == 1
    assert ran.err.startswith("moseg: cannot pin a run")
    assert len(ran.err.splitlines()) == 1


def test_a_lease_is_renewed_before_it_ends(tmp_path, monkeypatch):
    store = open_store(str(tmp_path / "store"), create=True)
    pins = RunPins(store, "run")
    pins.lease(["toy/" + "0" * 64])
    first = store.pin_of("run")
    pins.renew()
    assert store.pin_of("run") == first
    # Sooner than a collection takes the lease for that of a run that died.
    monkeypatch.setattr(time, "monotonic", lambda now=time.monotonic: now() + 0.6 * STEP_SECONDS)
    pins.renew()
    assert store.pin_of("run").expires > first.expires


def test_results_that_are_used_again_keep_the_name_of_their_run(tmp_path, monkeypatch):
    store, ref = open_store(str(tmp_path / "store"), create=True), "toy/" + "0" * 64
    RunPins(store, "first").keep([ref], is_new=True)
    ((name, before),) = store.pinned().items()
    monkeypatch.setattr(time, "time", lambda now=time.time: now() + 2 * RENEWED_SECONDS)
    RunPins(store, "second").keep([ref], is_new=False)
    assert store.pinned()[name].run == "first" and store.pinned()[name].created > before.created


def test_a_damaged_pin_of_the_same_results_is_replaced(tmp_path):
    store, ref = open_store(str(tmp_path / "store"), create=True), "toy/" + "0" * 64
    RunPins(store, "first").keep([ref], is_new=True)
    (path,) = (tmp_path / "store" / "pins").iterdir()
    path.write_bytes(b"")
    RunPins(store, "second").keep([ref], is_new=False)
    (pin,) = store.pinned().values()
    assert pin.refs == (ref,)


def test_a_damaged_pin_of_another_run_keeps_no_result_back(squares, tmp_path, moseg, monkeypatch):
    """Report what cannot be freed then, and end well."""
    video, store = squares / "squares" / "frames", tmp_path / "store"
    arguments = ("segment", video, "--out", tmp_path / "out", "--store", store)
    assert moseg(*arguments, "--quiet").code == 0
    (path,) = (store / "pins").iterdir()
    path.write_bytes(b"")
    ran = moseg(*arguments, "--set", "affinity.scale=0.8")
    assert ran.code == 0 and "cues stay in the store: unreadable pin" in ran.err
    monkeypatch.setenv("MOSEG_STORE_SIZE", "10G")
    ran = moseg(*arguments, "--set", "affinity.scale=0.9", "--keep-cues")
    assert ran.code == 0 and "nothing is removed: unreadable pin" in ran.err
