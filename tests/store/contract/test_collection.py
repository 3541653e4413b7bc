"""Pins, and the collection of what none of them reaches, on every kind of store."""

import subprocess
import sys
import time
import uuid

import pytest

from moseg.schemas.errors import StoreError
from moseg.schemas.recipes import Recipe
from moseg.store import collection
from moseg.store.local import moves
from moseg.store.owners import process_space
from moseg.store.remote import remote_store, trash

ABSENT = "toy/" + "f" * 64


@pytest.fixture
def dies_now(monkeypatch):
    """Return a function after which unfinished work of this process is that of one which has ended."""

    def die():
        dead = subprocess.Popen([sys.executable, "-c", ""])
        dead.wait()
        for module in (moves, trash, remote_store):
            monkeypatch.setattr(module, "owned_name", lambda: f"{process_space()}-{dead.pid}-{uuid.uuid4().hex}")

    return die


def test_pins_are_listed_until_unpinned(store, ref):
    store.pin("run-1", [ref, ABSENT])
    assert store.pinned()["run-1"].refs == (ref, ABSENT)
    assert store.pin_of("run-1") == store.pinned()["run-1"] and store.pin_of("run-2") is None
    assert store.unpin("run-1") and not store.unpin("run-1")
    assert store.pinned() == {}


def test_gc_keeps_all_that_a_pin_reaches(store, ref, toy):
    recipes = [toy.recipe]
    for number in range(3):
        recipes.append(Recipe(task="toy", version=number, inputs={"previous": recipes[-1].ref}))
        store.put(recipes[-1], {}, dims={})
    store.pin("run-1", [recipes[2].ref])
    assert store.gc(is_dry=False, grace_seconds=60).removed == ()
    assert store.gc(is_dry=False, grace_seconds=0).removed == (recipes[3].ref,)
    assert set(store.refs()) == {recipe.ref for recipe in recipes[:3]}


def test_artifacts_that_a_run_pins_during_the_sweep_are_restored(store, ref, monkeypatch):
    pins_seen = []

    def pinned_late(backend):
        pins_seen.append(store.pinned())
        if len(pins_seen) == 2:
            store.pin("late", [ref])
        return store.pinned() if len(pins_seen) == 2 else pins_seen[0]

    other = Recipe(task="apple", version=1)
    store.put(other, {}, dims={})
    monkeypatch.setattr(collection, "pinned", pinned_late)
    assert store.gc(is_dry=False, grace_seconds=0).removed == (other.ref,)
    assert list(store.refs()) == [ref]
    assert [result.is_intact for result in store.verify()] == [True]


def test_a_failed_sweep_restores_everything(store, ref, monkeypatch):
    calls = iter([{}, StoreError("unreadable pin")])

    def pinned(backend):
        answer = next(calls)
        if isinstance(answer, StoreError):
            assert not store.has(ref)
            raise answer
        return answer

    monkeypatch.setattr(collection, "pinned", pinned)
    with pytest.raises(StoreError, match="unreadable pin"):
        store.gc(is_dry=False, grace_seconds=0)
    assert [result.is_intact for result in store.verify([ref])] == [True]


def test_what_a_killed_sweep_took_returns_at_the_next_collection(store, ref, dies_now):
    other = Recipe(task="apple", version=1)
    store.put(other, {}, dims={})
    store.pin("run-1", [ref])
    dies_now()
    store.new_trash().take([ref, other.ref])
    assert list(store.refs()) == []
    assert store.gc().leftovers == ()
    assert store.gc(is_dry=False).removed == ()
    assert [result.is_intact for result in store.verify()] == [True, True]
    assert store.gc(is_dry=False).leftovers == ()


def test_what_a_killed_sweep_took_and_a_run_computed_again_is_a_leftover(store, ref, toy, dies_now):
    store.pin("run-1", [ref])
    dies_now()
    store.new_trash().take([ref])
    store.put(toy.recipe, toy.arrays, dims=toy.dims)
    preview, done = store.gc(), store.gc(is_dry=False)
    assert preview.leftovers == done.leftovers != ()
    assert store.gc().leftovers == ()
    assert store.attributes(ref) == {}
    assert [result.is_intact for result in store.verify()] == [True]


def test_gc_without_a_pin_previews_what_it_deletes(store, ref):
    store.pin("run-1", [ref])
    preview = store.gc(grace_seconds=0, forget=["run-1"])
    assert preview.removed == (ref,) and store.has(ref) and "run-1" in store.pinned()
    done = store.gc(is_dry=False, grace_seconds=0, forget=["run-1"])
    assert done.removed == preview.removed and done.nbytes == preview.nbytes
    assert list(store.refs()) == [] and store.pinned() == {}


def test_gc_to_a_size_removes_no_more_than_needed(store, ref, toy):
    others = [Recipe(task="toy", version=number) for number in (3, 4)]
    for recipe in others:
        store.put(recipe, toy.arrays, dims=toy.dims)
    store.pin("run-1", [ref])
    total = sum(use.nbytes for use in store.usage().values())
    assert store.gc(is_dry=False, grace_seconds=0, keep_nbytes=total).removed == ()
    report = store.gc(is_dry=False, grace_seconds=0, keep_nbytes=total - 1)
    assert len(report.removed) == 1 and report.removed[0] != ref
    assert report.left == sum(use.nbytes for use in store.usage().values())
    assert store.gc(is_dry=False, grace_seconds=0, keep_nbytes=0).left > 0
    assert list(store.refs()) == [ref]


def test_a_pin_without_inputs_keeps_only_what_it_names(store, ref):
    child = Recipe(task="apple", version=1, inputs={"toy": ref})
    store.put(child, {}, dims={})
    store.pin("run-1", [child.ref], run="a run", with_inputs=False)
    assert store.pin_of("run-1").run == "a run"
    assert store.gc(grace_seconds=0).removed == (ref,)
    assert store.release([ref, child.ref, ABSENT]) == 1
    assert list(store.refs()) == [child.ref]


def test_gc_deletes_what_no_pin_reaches(store, ref):
    other = Recipe(task="apple", version=1)
    store.put(other, {}, dims={})
    store.pin("run-1", [ref])
    assert store.gc(grace_seconds=0).removed == (other.ref,)
    assert store.has(other.ref)
    report = store.gc(is_dry=False, grace_seconds=0)
    assert report.removed == (other.ref,) and report.num_kept == 1 and report.nbytes > 0
    assert list(store.refs()) == [ref]


def test_what_is_written_while_a_run_is_at_work_is_spared(store, ref, monkeypatch):
    assert store.gc(grace_seconds=0).removed == (ref,)
    store.pin("run", [], lease_seconds=600)
    assert store.gc(grace_seconds=0, keep_nbytes=0).removed == ()
    # A run that died on another machine holds its lease for days.
    monkeypatch.setattr(collection, "STEP_SECONDS", -1.0)
    assert store.gc(grace_seconds=0).removed == (ref,)
    monkeypatch.undo()
    store.pin("run", [])
    assert store.gc(grace_seconds=0).removed == (ref,)


def test_a_run_at_work_for_hours_is_spared(store, ref, monkeypatch):
    monkeypatch.setattr(time, "time", lambda now=time.time: now() - 5 * 3600)
    store.pin("run", [], lease_seconds=86_400)
    monkeypatch.undo()
    assert store.gc(grace_seconds=0).removed == ()
