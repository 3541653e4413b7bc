"""`moseg store push` and `pull`: the copied artifacts, the messages, and the reuse of the copy by a run."""

import json

import pytest

from moseg.store import open_store, transfer


@pytest.fixture
def stores(evaluated, tmp_path):
    """Return the evaluated store, and an address without a store."""
    return evaluated.store, tmp_path / "other"


def _open(path):
    return open_store(str(path), create=False)


def _bad(ran, *words):
    assert (ran.code, ran.out) == (2, "")
    (line,) = ran.err.splitlines()
    assert all(str(word) in line for word in words)


@pytest.mark.parametrize("verb", ["push", "pull"])
def test_a_run_on_a_copy_computes_nothing_and_gives_the_same(evaluated, moseg, stores, tmp_path, verb):
    here, there = stores
    ends = (there, "--store", here) if verb == "push" else (here, "--store", there)
    ran = moseg("store", verb, *ends, "--quiet")
    assert (ran.code, ran.err) == (0, "")
    count = len(list(_open(here).refs()))
    assert ran.out.startswith(f"{count} artifacts copied (")
    assert ran.out.endswith("), 0 were there already, 0 damaged\n")
    again = moseg("store", verb, *ends, "--quiet").out
    assert again == f"0 artifacts copied (0 B), {count} were there already, 0 damaged\n"
    assert moseg(*evaluated.arguments, "--store", there, "--json", tmp_path / "again.json").code == 0
    report = json.loads((tmp_path / "again.json").read_text())
    assert report["store"]["computed"] == 0
    assert report["rows"] == evaluated.report["rows"]


def test_a_collection_keeps_what_was_copied(moseg, stores):
    here, there = stores
    assert moseg("store", "push", there, "--store", here).code == 0
    assert _open(there).gc(is_dry=False, grace_seconds=0).removed == ()
    pins = [{name: pin.refs for name, pin in _open(each).pinned().items()} for each in stores]
    assert pins[0] == pins[1]


def test_a_run_is_copied_with_the_artifacts_that_it_reaches_and_no_others(evaluated_copy, moseg, stores):
    there, store = stores[1], ("--store", evaluated_copy.store)
    first = set(_open(evaluated_copy.store).refs())
    (run,) = _open(evaluated_copy.store).pinned()
    assert moseg(*evaluated_copy.arguments, *store, "--set", "affinity.scale=0.8").code == 0
    assert first < set(_open(evaluated_copy.store).refs())
    assert moseg("store", "push", there, "--run", run, "--quiet", *store).code == 0
    assert set(_open(there).refs()) == first
    assert list(_open(there).pinned()) == [run]


def test_a_run_can_be_named_as_by_status(evaluated_copy, moseg, stores):
    store = ("--store", evaluated_copy.store)
    assert moseg(*evaluated_copy.arguments, *store, "--set", "affinity.scale=0.8").code == 0
    (before,) = _open(stores[0]).pinned()
    assert moseg("store", "push", stores[1], "--run", "latest", "--quiet", *store).code == 0
    (after,) = _open(stores[1]).pinned()
    assert after != before
    assert after in _open(evaluated_copy.store).pinned()


def test_a_task_is_copied_with_its_inputs_and_pinned(moseg, stores):
    here, there = stores
    assert moseg("store", "pull", here, "--task", "linking", "--store", there, "--quiet").code == 0
    tasks = {ref.partition("/")[0] for ref in _open(there).refs()}
    assert {"linking", "proposals", "frame"} <= tasks
    assert "score" not in tasks
    assert _open(there).gc(is_dry=False, grace_seconds=0).removed == ()


def test_results_can_be_copied_without_their_inputs(moseg, stores):
    here, there = stores
    ran = moseg("store", "pull", here, "--task", "segmentation", "--no-inputs", "--store", there, "--quiet")
    assert ran.code == 0
    assert list(_open(there).refs()) == list(_open(here).refs("segmentation"))
    assert _open(there).gc(is_dry=False, grace_seconds=0).removed == ()


def test_keys_can_be_abbreviated(moseg, stores):
    here, there = stores
    (score,) = _open(here).refs("score")
    assert moseg("store", "push", there, score[:16], "--no-inputs", "--store", here, "--quiet").code == 0
    assert list(_open(there).refs()) == [score]


def test_dry_reports_and_changes_nothing(moseg, stores):
    here, there = stores
    ran = moseg("store", "push", there, "--dry", "--store", here)
    assert (ran.code, ran.err) == (0, "")
    count = len(list(_open(here).refs()))
    assert any(line.split()[-2:] == [str(count), "total"] for line in ran.out.splitlines())
    assert not there.exists()


def test_damage_is_named_and_the_rest_is_copied(evaluated_copy, moseg, stores):
    packed = next((evaluated_copy.store / "objects" / "flow").rglob("arrays.zip"))
    packed.write_bytes(packed.read_bytes()[:-1])
    ran = moseg("store", "push", stores[1], "--store", evaluated_copy.store, "--quiet")
    assert ran.code == 1
    ref = f"flow/{packed.parent.name}"
    assert ran.out.splitlines()[0].startswith(f"{ref}: not copied: ")
    assert ran.out.endswith("1 damaged\n")
    assert set(_open(stores[1]).refs()) == set(_open(stores[0]).refs()) - {ref}


def test_progress_goes_to_standard_error(moseg, stores, monkeypatch):
    monkeypatch.setattr("moseg.workflows.process.progress_displays.PLAIN_FIRST_SEC", 0)
    ran = moseg("store", "push", stores[1], "--store", stores[0])
    assert "artifacts in " in ran.err
    assert len(ran.out.splitlines()) == 1


def test_an_invalid_copy_is_one_line_and_creates_no_store(moseg, stores, tmp_path):
    here, there = stores
    push = ("store", "push", there, "--store", here)
    _bad(moseg(*push, "--run", "nobody"), "nobody")
    _bad(moseg(*push, "flow/zz"), "flow/zz")
    _bad(moseg(*push, "--task", "nothing"), "nothing")
    _bad(moseg(*push, "--no-inputs"), "--no-inputs")
    _bad(moseg("store", "push", there, "--store", tmp_path / "none"), tmp_path / "none")
    _bad(moseg("store", "pull", tmp_path / "none", "--store", there), tmp_path / "none")
    assert not there.exists()
    _bad(moseg("store", "push", here, "--store", here), "same store")
    _bad(moseg("store", "push", "ftp://host/store", "--store", here), "ftp://")
    (tmp_path / "thesis").mkdir()
    (tmp_path / "thesis" / "thesis.tex").touch()
    _bad(moseg("store", "push", tmp_path / "thesis", "--store", here), "thesis")


def test_an_unfinished_run_cannot_be_copied(evaluated_copy, moseg, stores):
    store = _open(evaluated_copy.store)
    store.pin("live-one", list(store.refs("flow")), lease_seconds=600)
    _bad(moseg("store", "push", stores[1], "--run", "live-one", "--store", evaluated_copy.store), "live-one")
    assert moseg("store", "push", stores[1], "--store", evaluated_copy.store, "--quiet").code == 0
    assert "live-one" not in _open(stores[1]).pinned()


def test_a_collection_at_the_target_during_a_copy_deletes_nothing(moseg, stores, monkeypatch):
    here, there = stores
    copy, collections = transfer.transfer, []

    def copy_and_collect(source, target, *rest):
        report = copy(source, target, *rest)
        collections.append(target.gc(is_dry=False, grace_seconds=0).removed)
        return report

    monkeypatch.setattr(transfer, "transfer", copy_and_collect)
    assert moseg("store", "push", there, "--store", here, "--quiet").code == 0
    assert collections == [()]
    assert list(_open(there).refs()) == list(_open(here).refs())
