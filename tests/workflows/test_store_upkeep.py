"""`moseg store verify` and `gc` beyond the tests in test_cli.py: progress, and logs of ended runs."""

import os

import pytest

from moseg.store import open_store

LONG_AGO = 1_000_000_000


def test_verify_reports_its_progress_unless_quiet(evaluated, moseg, monkeypatch):
    monkeypatch.setattr("moseg.workflows.process.progress_displays.PLAIN_FIRST_SEC", 0)
    loud = moseg("store", "verify", "--store", evaluated.store)
    quiet = moseg("store", "verify", "--quiet", "--store", evaluated.store)
    assert "artifacts in " in loud.err and loud.err.count("\n") == 1
    assert quiet.err == ""
    assert quiet.out == loud.out


def test_an_artifact_that_vanishes_while_it_is_verified_is_skipped(evaluated_copy, moseg, monkeypatch):
    store = open_store(str(evaluated_copy.store), create=False)
    refs = list(store.refs())
    monkeypatch.setattr("moseg.store.LocalStore.refs", lambda self, task=None: iter(refs))
    store.remove(refs[0])
    ran = moseg("store", "verify", "--quiet", "--store", evaluated_copy.store)
    assert (ran.code, ran.out) == (0, f"{len(refs) - 1} artifacts, 0 bad\n")


@pytest.fixture
def old_log(evaluated_copy):
    """Write the log of a run that ended long ago into a store of the test's own, and return its name."""
    store = open_store(str(evaluated_copy.store), create=False)
    store.append_log("20010909-old", b"{}\n")
    for path in (evaluated_copy.store / "logs" / "20010909-old").iterdir():
        os.utime(path, (LONG_AGO, LONG_AGO))
    return "20010909-old"


def test_gc_removes_old_logs_with_delete_only(evaluated_copy, moseg, old_log):
    store = open_store(str(evaluated_copy.store), create=False)
    kept = set(store.logs()) - {old_log}
    assert kept
    collect = ("store", "gc", "--store", evaluated_copy.store)
    assert "logs of 1 ended runs would be removed" in moseg(*collect).out
    assert set(store.logs()) == kept | {old_log}
    assert "logs of 1 ended runs removed" in moseg(*collect, "--delete").out
    assert set(store.logs()) == kept


def test_gc_keeps_logs_of_active_runs(evaluated_copy, moseg, old_log):
    store = open_store(str(evaluated_copy.store), create=False)
    store.pin(old_log, [], lease_seconds=600)
    assert moseg("store", "gc", "--delete", "--store", evaluated_copy.store).code == 0
    assert old_log in store.logs()


def test_gc_forgets_a_run_as_status_names_it(evaluated_copy, moseg):
    store = open_store(str(evaluated_copy.store), create=False)
    ran = moseg("store", "gc", "--forget", "latest", "--delete", "--grace-hours", "0", "--store", evaluated_copy.store)
    assert ran.code == 0
    assert list(store.refs()) == []
