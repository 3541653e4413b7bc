"""Pins and mark-and-sweep."""

import errno
import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from moseg.schemas.errors import InputError, StoreError
from moseg.store import LocalStore, collection, pins
from moseg.store.local import moves
from moseg.store.names import slot
from moseg.store.owners import is_running, process_space

DAY = 86_400.0


@pytest.fixture
def chain(store: LocalStore, put_toy) -> list[str]:
    """Put four artifacts, each computed from the one before it."""
    refs = [put_toy(store, 0)]
    for number in range(1, 4):
        refs.append(put_toy(store, number, inputs={"previous": refs[-1]}))
    return refs


def test_gc_keeps_all_that_a_pin_reaches(store, chain):
    store.pin("run", [chain[2]])
    assert store.gc(grace_seconds=0).removed == (chain[3],)
    report = store.gc(is_dry=False, grace_seconds=0)
    assert report.removed == (chain[3],) and report.num_kept == 3
    assert set(store.refs()) == set(chain[:3])


def test_gc_is_dry_by_default(store, chain):
    report = store.gc(grace_seconds=0)
    assert report.is_dry and set(report.removed) == set(chain)
    assert report.nbytes == sum(usage.nbytes for usage in store.usage().values())
    assert set(store.refs()) == set(chain)


def test_gc_keeps_artifacts_younger_than_the_grace_period(store, chain):
    assert store.gc(is_dry=False).removed == ()
    assert store.gc(is_dry=False, grace_seconds=60).removed == ()


def test_an_input_that_is_not_stored_ends_the_walk(store, chain):
    store.remove(chain[1])
    store.pin("run", [chain[3]])
    store.gc(is_dry=False, grace_seconds=0)
    assert set(store.refs()) == {chain[2], chain[3]}


def test_a_damaged_manifest_ends_the_walk_but_its_artifact_stays(store, chain):
    task, key = chain[2].split("/")
    (store.root / "objects" / task / key[:2] / key / "manifest.json").write_bytes(b"")
    store.pin("run", [chain[3]])
    store.gc(is_dry=False, grace_seconds=0)
    assert set(store.refs()) == {chain[2], chain[3]}


def test_artifacts_that_a_run_pins_during_the_sweep_are_restored(store, chain, monkeypatch):
    pins_seen = []

    def pinned_late(layout):
        pins_seen.append(store.pinned())
        if len(pins_seen) == 1:
            store.pin("late", [chain[1]])
            return pins_seen[0]
        return store.pinned()

    monkeypatch.setattr(collection, "pinned", pinned_late)
    report = store.gc(is_dry=False, grace_seconds=0)
    assert set(report.removed) == {chain[2], chain[3]}
    assert set(store.refs()) == {chain[0], chain[1]}
    assert [result.is_intact for result in store.verify()] == [True, True]


def test_a_pin_protects_an_artifact_that_is_stored_later(store, put_toy):
    ref = put_toy(store, 5)
    store.remove(ref)
    store.pin("run", [ref])
    put_toy(store, 5)
    store.gc(is_dry=False, grace_seconds=0)
    assert store.has(ref)


def test_a_lease_ends(store, chain, monkeypatch):
    store.pin("run", chain, lease_seconds=DAY)
    assert store.gc(grace_seconds=0).removed == ()
    now = time.time()
    monkeypatch.setattr(time, "time", lambda: now + DAY + 1)
    assert store.pinned() == {}


def test_a_lease_ends_with_its_process_but_a_pin_without_lease_does_not(store, chain):
    code = (
        "import sys; from moseg.store import LocalStore; store = LocalStore(sys.argv[1])\n"
        "store.pin('live', [sys.argv[2]], lease_seconds=1e6)\n"
        "store.pin('kept', [sys.argv[2]])"
    )
    subprocess.run([sys.executable, "-c", code, store.root, chain[0]], check=True)
    assert store.pinned().keys() == {"kept"}


def test_a_lease_of_another_host_holds_until_it_ends(store, chain):
    store.pin("run", chain, lease_seconds=DAY)
    path = store.root / "pins" / "run.json"
    pin = json.loads(path.read_text())
    path.write_text(json.dumps(pin | {"space": "0" * 16, "pid": 1}))
    assert store.pinned().keys() == {"run"}


def test_pinning_again_replaces_the_pin(store, chain):
    store.pin("run", chain, lease_seconds=DAY)
    store.pin("run", chain[:1])
    assert store.pinned()["run"].refs == (chain[0],)
    assert [path.name for path in (store.root / "pins").iterdir()] == ["run.json"]


def test_an_unreadable_pin_stops_the_collection(store, chain):
    store.pin("run", chain)
    (store.root / "pins" / "run.json").write_text("{")
    with pytest.raises(StoreError, match=r"run\.json"):
        store.gc(is_dry=False, grace_seconds=0)
    assert set(store.refs()) == set(chain)


@pytest.mark.parametrize("run_id", ["", "../run", "a/b", ".hidden", "x" * 101])
def test_run_names_must_be_file_names(store, run_id):
    with pytest.raises(InputError, match="run name"):
        store.pin(run_id, [])


def test_malformed_references_cannot_be_pinned(store):
    with pytest.raises(InputError, match="reference"):
        store.pin("run", ["toy/0"])


def test_gc_removes_staging_of_dead_processes_and_old_quarantine_only(store, chain):
    staging, quarantine = store.root / "staging", store.root / "quarantine"
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    ours, theirs = staging / f"{process_space()}-{os.getpid()}-{'0' * 32}", staging / f"{'0' * 16}-1-{'0' * 32}"
    left = staging / f"{process_space()}-{dead.pid}-{'0' * 32}"
    for folder in (ours, theirs, left):
        folder.mkdir(parents=True)
    store.quarantine(chain[3], "damaged")
    (damaged,) = quarantine.iterdir()
    report = store.gc(is_dry=False)
    assert report.leftovers == (f"staging/{left.name}",)
    assert ours.is_dir() and theirs.is_dir() and damaged.is_dir() and not left.exists()
    for folder in (theirs, damaged):
        os.utime(folder, (0, 0))
    assert set(store.gc(is_dry=False).leftovers) == {f"staging/{theirs.name}", f"quarantine/{damaged.name}"}


def test_a_sweep_that_cannot_restore_an_artifact_keeps_it_for_the_next_collection(store, chain, monkeypatch):
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    rename, lost = os.rename, slot(chain[1])

    def pin_late(backend):
        if not store.has(chain[0]):
            store.pin("late", chain)
        return store.pinned()

    def fail(source, target):
        if str(target).endswith(f"{store.root}/objects/{lost}"):
            raise OSError(errno.EIO, "Input/output error")
        rename(source, target)

    with monkeypatch.context() as faulty:
        faulty.setattr(collection, "pinned", pin_late)
        faulty.setattr(moves, "owned_name", lambda: f"{process_space()}-{dead.pid}-{'0' * 32}")
        faulty.setattr(moves.os, "rename", fail)
        with pytest.raises(StoreError, match="Input/output error"):
            store.gc(is_dry=False, grace_seconds=0)
    assert not store.has(chain[1])
    assert store.gc().leftovers == ()
    store.gc(is_dry=False)
    assert [result.is_intact for result in store.verify()] == [True] * 4
    assert list((store.root / "staging").iterdir()) == []


def test_a_sweep_interrupted_after_a_rename_restores_the_artifact(store, chain, monkeypatch):
    rename = os.rename

    def interrupt(source, target):
        rename(source, target)
        if str(source).endswith(f"{store.root}/objects/{slot(chain[2])}"):
            raise KeyboardInterrupt

    with monkeypatch.context() as faulty:
        faulty.setattr(moves.os, "rename", interrupt)
        with pytest.raises(KeyboardInterrupt):
            store.release(chain)
    assert [result.is_intact for result in store.verify()] == [True] * 4


def test_what_a_sweep_was_deleting_when_it_was_killed_does_not_return(store, chain, monkeypatch):
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    with monkeypatch.context() as killed:
        killed.setattr(moves, "owned_name", lambda: f"{process_space()}-{dead.pid}-{'0' * 32}")
        killed.setattr(moves.shutil, "rmtree", lambda *arguments, **options: None)
        assert store.release(chain) == 4
    assert len(store.gc(is_dry=False).leftovers) == 1
    assert list(store.refs()) == [] and list((store.root / "staging").iterdir()) == []


def test_gc_removes_pins_that_no_longer_hold_and_no_others(store, chain):
    store.pin("ended", chain, lease_seconds=-1.0)
    store.pin("leased", chain[:1], lease_seconds=DAY)
    store.pin("kept", chain[:1])
    path = store.root / "pins" / "ended.json"
    report = store.gc()
    assert report.leftovers == ("pins/ended.json",) and report.nbytes == path.stat().st_size
    assert path.exists()
    assert store.gc(is_dry=False).leftovers == ("pins/ended.json",)
    assert not path.exists() and store.pinned().keys() == {"leased", "kept"}


def test_a_pin_that_is_renewed_during_a_collection_stays(store, chain):
    store.pin("run", chain, lease_seconds=-1.0)
    found = pins.ended_pins(store)
    store.pin("run", chain)
    pins.discard_ended(store, found)
    assert store.pinned().keys() == {"run"}


def test_a_record_that_cannot_be_written_leaves_no_partial_file(store, chain, monkeypatch):
    def fail(path, target):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(StoreError, match="cannot pin"):
        store.pin("run", chain)
    assert list((store.root / "pins").iterdir()) == []


def test_gc_removes_old_partial_records(store):
    store.pin("run", [])
    new, old = (store.root / "pins" / f"{name}.json.{'0' * 32}.partial" for name in ("new", "old"))
    for path in (new, old):
        path.write_bytes(b"{")
    os.utime(old, (0, 0))
    report = store.gc(is_dry=False)
    assert (report.leftovers, report.nbytes) == ((f"pins/{old.name}",), 1)
    assert new.exists() and not old.exists()


def test_the_state_of_a_process_of_another_space_is_unknown():
    assert is_running(process_space(), os.getpid()) is True
    assert is_running("0" * 16, os.getpid()) is None
