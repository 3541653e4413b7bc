"""Collections, removals and quarantine on an object store that other processes use too."""

import json
import subprocess
import sys
import time

import numpy as np
import obstore
import pytest
from obstore.exceptions import AlreadyExistsError, GenericError

from moseg.schemas.errors import StoreError
from moseg.schemas.recipes import Recipe
from moseg.store import collection, open_store
from moseg.store.names import slot
from moseg.store.owners import owned_name
from moseg.store.remote import logs, remote_store, trash
from moseg.store.remote import requests as remote_requests
from moseg.store.remote.connection import connect
from moseg.store.remote.layout import aside_name, manifest_name
from moseg.store.remote.trash import RemoteTrash

DAY = 86_400.0


@pytest.fixture
def store(s3):
    return open_store(s3)


@pytest.fixture
def names(s3):
    """Return a function that lists the names of the objects in a folder."""
    client = connect(s3)
    return lambda folder: sorted(item["path"] for item in obstore.list(client, folder).collect())


@pytest.fixture
def dead_name() -> str:
    """Return a name that a process that has ended gave to unfinished work."""
    code = "from moseg.store.owners import owned_name; print(owned_name())"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()


@pytest.fixture
def put_by_the_dead(dead_name, monkeypatch) -> None:
    """Make each put of this test that of a process that has ended."""
    monkeypatch.setattr(remote_store, "owned_name", lambda: dead_name)


def put_orphan(store, s3, attempt: str) -> str:
    """Write files of a put without its manifest."""
    folder = f"payloads/toy/{'0' * 2}/{'0' * 64}/{attempt}"
    obstore.put(connect(s3), f"{folder}/zarr.json", b"{}")
    return folder


def as_of(monkeypatch, seconds: float) -> None:
    now = time.time()
    monkeypatch.setattr(collection.time, "time", lambda: now + seconds)


def test_removed_and_collected_artifacts_leave_no_object(store, put_toy, names):
    for number in range(4):
        put_toy(store, number)
    assert store.remove(next(store.refs()))
    assert len(store.gc(is_dry=False, grace_seconds=0).removed) == 3
    assert names("") == ["moseg-store.json"]


def test_orphans_go_after_their_process_has_ended_or_a_day(store, s3, dead_name, monkeypatch, put_toy):
    ref = put_toy(store)
    ours, theirs = put_orphan(store, s3, owned_name()), put_orphan(store, s3, f"{'0' * 16}-1-{'0' * 32}")
    left = put_orphan(store, s3, dead_name)
    report = store.gc(grace_seconds=0)
    assert report.leftovers == (left,)
    assert report.nbytes == store.usage()["toy"].nbytes + len(b"{}")
    assert store.gc(is_dry=False).leftovers == (left,)
    assert store.gc().leftovers == ()
    as_of(monkeypatch, DAY + 60)
    store.pin("run", [ref])
    assert set(store.gc(is_dry=False).leftovers) == {ours, theirs}
    assert [result.is_intact for result in store.verify()] == [True]


def test_files_that_a_manifest_names_are_not_orphans(store, s3, monkeypatch, put_toy, names):
    ref = put_toy(store)
    key = ref.split("/")[1]
    obstore.put(connect(s3), f"payloads/toy/{key[:2]}/{key}/{'0' * 16}-1-{'0' * 32}/zarr.json", b"{}")
    as_of(monkeypatch, DAY + 60)
    store.pin("run", [ref])
    assert len(store.gc(is_dry=False).leftovers) == 1
    assert [result.is_intact for result in store.verify()] == [True]


def test_artifacts_taken_by_another_collection_are_skipped(store, put_toy, names, put_by_the_dead):
    ref = put_toy(store)
    other = RemoteTrash(store._requests)
    other.take([ref])
    assert not store.has(ref) and len(names("aside")) == 1
    assert store.gc(is_dry=False, grace_seconds=0)[1:3] == ((), ())
    other.restore([ref])
    assert names("aside") == [] and [result.is_intact for result in store.verify()] == [True]

    other.take([ref])
    late = RemoteTrash(store._requests)
    other_manifest = other.read_manifests([ref])[ref]
    obstore.put(connect(store.url), manifest_name(ref), other_manifest)
    late.take([ref])
    late.empty()
    assert late.taken == set() and store.has(ref)


def test_leftovers_of_a_killed_collection_are_deleted(store, s3, put_toy, names, dead_name, put_by_the_dead):
    refs = [put_toy(store, number) for number in range(2)]
    client = connect(s3)
    for ref in refs:
        manifest = obstore.get(client, manifest_name(ref)).bytes().to_bytes()
        obstore.put(client, aside_name(ref), dead_name.encode() + b"\n" + manifest)
    # one manifest was already deleted
    obstore.delete(client, manifest_name(refs[1]))
    # the files of the other one too, as the last thing but its copy
    (packed,) = names(f"payloads/{slot(refs[1])}")
    obstore.delete(client, packed)
    put_orphan(store, s3, dead_name)
    preview, report = store.gc(), store.gc(is_dry=False)
    assert len(report.leftovers) == 3 and report.leftovers == preview.leftovers and report.removed == ()
    assert names("aside") == [] and [result.is_intact for result in store.verify()] == [True]
    assert len({name.split("/")[3] for name in names("payloads")}) == 1


def fail_at(monkeypatch, name: str, request: str) -> None:
    """Let a server answer 503 to requests for an object, and others of the same kind late."""
    real = getattr(obstore, request)

    def answer(client, path, *arguments, **options):
        if path == name:
            raise GenericError("Generic S3 error: Server returned non-2xx status code: 503 Slow Down: ")
        time.sleep(0.2)
        return real(client, path, *arguments, **options)

    monkeypatch.setattr(remote_requests.obstore, request, answer)


def test_a_sweep_that_cannot_delete_a_manifest_restores_everything(store, put_toy, names, monkeypatch):
    refs = [put_toy(store, number) for number in range(6)]
    for collect in (lambda: store.gc(is_dry=False, grace_seconds=0), lambda: store.release(refs)):
        with monkeypatch.context() as faulty:
            fail_at(faulty, manifest_name(refs[2]), "delete")
            with pytest.raises(StoreError, match="cannot delete objects: the server answers 503"):
                collect()
        assert [result.is_intact for result in store.verify()] == [True] * 6
        assert names("aside") == []
    assert store.release(refs) == 6 and names("") == ["moseg-store.json"]


def test_an_artifact_whose_manifest_cannot_be_deleted_is_not_removed(store, put_toy, names, monkeypatch):
    ref = put_toy(store)
    with monkeypatch.context() as faulty:
        fail_at(faulty, manifest_name(ref), "delete")
        with pytest.raises(StoreError, match="503"):
            store.remove(ref)
    assert [result.is_intact for result in store.verify()] == [True] and names("aside") == []


def test_what_a_failed_sweep_cannot_restore_returns_at_the_next_collection(
    store, put_toy, names, monkeypatch, dead_name
):
    refs = [put_toy(store, number) for number in range(3)]

    def pinned(backend):
        if not store.has(refs[0]):
            store.pin("run", refs)
            fail_at(faulty, manifest_name(refs[1]), "put")
        return store.pinned()

    with monkeypatch.context() as faulty:
        faulty.setattr(collection, "pinned", pinned)
        faulty.setattr(trash, "owned_name", lambda: dead_name)
        with pytest.raises(StoreError, match="cannot write objects: the server answers 503"):
            store.gc(is_dry=False, grace_seconds=0)
    assert not store.has(refs[1])
    assert store.gc(is_dry=False).removed == ()
    assert [result.is_intact for result in store.verify()] == [True] * 3
    assert names("aside") == []


def test_a_copy_that_a_killed_collection_left_does_not_prevent_removal(store, s3, put_toy, names, dead_name):
    ref = put_toy(store)
    obstore.put(connect(s3), aside_name(ref), dead_name.encode() + b"\n")
    assert store.remove(ref)
    assert names("") == ["moseg-store.json"]


def test_an_artifact_computed_again_during_a_collection_stays(store, put_toy, names):
    ref = put_toy(store)
    trash = RemoteTrash(store._requests)
    trash.take([ref])
    store.put(Recipe(task="toy", version=1, params={"number": 0}), {"x": np.ones(3)}, dims={"x": ("a",)})
    trash.restore([ref])
    trash.empty()
    assert np.array_equal(store.read(ref, "x", check=True), np.ones(3))
    assert [result.is_intact for result in store.verify()] == [True]
    assert names("aside") == [] and len({name.split("/")[4] for name in names("payloads")}) == 1


def test_damage_is_quarantined_with_its_bytes_and_reason(store, s3, put_toy, names):
    ref = put_toy(store)
    client = connect(s3)
    (packed,) = names("payloads")
    obstore.put(client, packed, b"junk")
    assert store.quarantine(ref, "file of another length") and not store.quarantine(ref, "again")
    kept = {name.split("/", 2)[2]: obstore.get(client, name).bytes().to_bytes() for name in names("quarantine")}
    assert kept.keys() == {"reason.json", "artifact/manifest.json", "artifact/arrays.zip"}
    assert kept["artifact/arrays.zip"] == b"junk"
    reason = json.loads(kept["reason.json"])
    assert (reason["ref"], reason["reason"]) == (ref, "file of another length")
    assert names("payloads") == [] and names("objects") == []
    assert put_toy(store) == ref and [result.is_intact for result in store.verify()] == [True]


def test_a_damaged_manifest_is_quarantined_and_its_files_are_leftovers(store, s3, put_toy, names, monkeypatch):
    ref = put_toy(store)
    obstore.put(connect(s3), manifest_name(ref), b"{}")
    assert store.quarantine(ref, "the seal is broken")
    assert not store.has(ref)
    put_toy(store)
    store.pin("run", [ref])
    as_of(monkeypatch, DAY + 60)
    assert len(store.gc(is_dry=False).leftovers) == 2
    assert names("quarantine") == [] and [result.is_intact for result in store.verify()] == [True]


def test_a_collection_of_a_manifest_that_is_damaged_deletes_it(store, s3, put_toy, names, monkeypatch):
    ref = put_toy(store)
    obstore.put(connect(s3), manifest_name(ref), b"{}")
    assert store.gc(is_dry=False, grace_seconds=0).removed == (ref,)
    as_of(monkeypatch, DAY + 60)
    store.gc(is_dry=False)
    assert names("") == ["moseg-store.json"]


def test_a_process_with_a_reused_number_writes_its_own_log(store, monkeypatch):
    store.append_log("run", b"one\n")
    monkeypatch.setattr(logs, "_writers", {})
    monkeypatch.setattr(logs, "_counter", iter(range(1000)))
    for number in range(12):
        store.append_log("run", f"{number}\n".encode())
    lines = store.read_log("run")
    assert len(lines) == 13
    assert [line for line in lines if line != b"one"] == [str(number).encode() for number in range(12)]


def test_many_lookups_and_reads_run_concurrently(store, put_toy):
    recipe = Recipe(task="toy", version=1, params={"number": 1})
    array = np.arange(200 * 3 * 2).reshape(200, 3, 2)
    store.put(recipe, {"x": array}, dims={"x": ("frame", "y", "x")})
    absent = {f"toy/{number:064x}" for number in range(200)}
    assert store.present([*absent, recipe.ref]) == {recipe.ref}
    assert np.array_equal(store.read(recipe.ref, "x", check=True), array)


def test_an_artifact_whose_restoring_was_answered_late_keeps_its_files(store, put_toy, names, monkeypatch):
    ref = put_toy(store)
    trash = RemoteTrash(store._requests)
    trash.take([ref])
    real = obstore.put

    def answer_lost(client, name, content, **options):
        real(client, name, content, **options)
        raise AlreadyExistsError("written by the first of two requests")

    monkeypatch.setattr(remote_requests.obstore, "put", answer_lost)
    trash.restore([ref])
    trash.empty()
    assert [result.is_intact for result in store.verify()] == [True] and names("aside") == []


def test_pins_that_no_longer_hold_are_leftovers(store, put_toy, names):
    ref = put_toy(store)
    store.pin("ended", [ref], lease_seconds=-1.0)
    store.pin("kept", [ref])
    assert store.gc().leftovers == ("pins/ended.json",)
    store.gc(is_dry=False)
    assert names("pins") == ["pins/kept.json"] and store.has(ref)


def test_a_commit_waits_longer_after_each_conflict(store, put_toy, monkeypatch):
    pauses = []
    monkeypatch.setattr(remote_store.time, "sleep", pauses.append)
    monkeypatch.setattr(remote_requests.Requests, "create", lambda self, name, content: False)
    with pytest.raises(StoreError, match="puts and removes"):
        put_toy(store)
    assert pauses[0] == 0.0 and pauses == sorted(set(pauses)) and len(pauses) == 3
