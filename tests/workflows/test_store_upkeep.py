"""`moseg store verify` and `gc` beyond the tests in test_cli.py: progress, and logs of ended runs."""

import os
import time

import numpy as np
import pytest

from moseg.schemas.recipes import Recipe
from moseg.store import open_store
from moseg.workflows.process.amounts import read_age, read_size

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


def _age(store, days):
    """Set the last use of everything in a store, pins included, to some days ago."""
    before = time.time() - days * 86_400
    for pin in store.pinned().values():
        old = pin.model_copy(update={"created": before})
        (store.root / "pins" / f"{pin.run_id}.json").write_text(old.model_dump_json())
    for ref in store.refs():
        task, key = ref.split("/")
        os.utime(store.root / "objects" / task / key[:2] / key, (before, before))


def test_a_run_has_one_name_everywhere(evaluated, moseg):
    store = ("--store", evaluated.store)
    (line,) = moseg("store", "ls", "--runs", *store).out.splitlines()
    run = line.split()[0]
    assert run in moseg("status", *store).out
    assert moseg("status", run, *store).code == 0
    assert "1 pins of runs would be removed" in moseg("store", "gc", "--forget", run[:-3], *store).out


def test_gc_of_older_runs_removes_them_as_its_preview_says(evaluated_copy, moseg):
    store = open_store(str(evaluated_copy.store), create=False)
    collect = ("store", "gc", "--quiet", "--store", evaluated_copy.store)
    _age(store, days=6)
    assert moseg(*collect, "--older", "7d", "--delete").out.startswith("0 artifacts, ")
    _age(store, days=8)
    count = len(list(store.refs()))
    assert moseg(*collect).out.startswith("0 artifacts, ")
    preview = moseg(*collect, "--older", "7d", "--dry-run").out
    assert len(list(store.refs())) == count
    done = moseg(*collect, "--older", "7d", "--delete").out
    assert f"{count} artifacts, " in done and list(store.refs()) == [] and store.pinned() == {}
    assert preview.replace(" would be removed (--delete does it)", " removed").replace("would be ", "") == done


def test_a_run_that_is_used_again_is_not_older(evaluated_copy, moseg):
    store = open_store(str(evaluated_copy.store), create=False)
    _age(store, days=8)
    ran = moseg(*evaluated_copy.arguments, "--store", evaluated_copy.store)
    assert "0 artifacts computed" in ran.out
    ran = moseg("store", "gc", "--older", "7d", "--delete", "--quiet", "--store", evaluated_copy.store)
    assert ran.out.startswith("0 artifacts, ")


def test_a_size_is_kept_by_removing_the_least_recently_used(tmp_path, put_numbers, moseg):
    store = open_store(str(tmp_path / "store"))
    refs = put_numbers(store, 4)
    for days, ref in enumerate(refs):
        _age_one(store, ref, days + 2)
    store.pin("kept", [refs[3]])
    store.touch([refs[2]])
    each = store.nbytes(refs)[refs[0]]
    collect = ("store", "gc", "--quiet", "--store", tmp_path / "store", "--grace-hours", "1")
    assert moseg(*collect, "--keep-size", str(4 * each)).out.startswith("0 artifacts, ")
    preview = moseg(*collect, "--keep-size", str(3 * each)).out
    assert preview.splitlines()[0] == refs[1] and "1 artifacts, " in preview
    assert moseg(*collect, "--keep-size", str(3 * each), "--delete").code == 0
    assert store.present(refs) == {refs[0], refs[2], refs[3]}
    # one is pinned and one was used within the hour
    ran = moseg(*collect, "--keep-size", "1", "--delete")
    assert store.present(refs) == {refs[2], refs[3]}
    assert "stay, more than 1 B" in ran.out


@pytest.mark.parametrize(
    "option", [("--older", "7"), ("--older", "soon"), ("--keep-size", "20 apples"), ("--keep-size", "-1G")]
)
def test_other_amounts_are_bad_input(evaluated, moseg, option):
    ran = moseg("store", "gc", f"{option[0]}={option[1]}", "--store", evaluated.store)
    assert ran.code == 2 and option[0] in ran.err and ran.err.count("\n") == 1


def test_amounts_have_the_usual_units():
    assert [read_size(text, "") for text in ("7", "1k", "20G", "500 MiB", "1.5TB")] == [
        7,
        2**10,
        20 * 2**30,
        500 * 2**20,
        3 * 2**39,
    ]
    assert [read_age(text, "") for text in ("90m", "12h", "7d", "2w")] == [5400, 43_200, 604_800, 1_209_600]


def _age_one(store, ref, days):
    task, key = ref.split("/")
    moment = time.time() - days * 86_400
    os.utime(store.root / "objects" / task / key[:2] / key, (moment, moment))


@pytest.fixture
def put_numbers():
    def put(store, count):
        recipes = [Recipe(task="toy", version=1, params={"number": number}) for number in range(count)]
        for recipe in recipes:
            store.put(recipe, {"x": np.zeros(1000)}, dims={"x": ("a",)})
        return [recipe.ref for recipe in recipes]

    return put
