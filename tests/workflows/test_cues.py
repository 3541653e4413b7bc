"""`moseg segment` keeps results and lets go of cues that are cheap to compute again; nothing that others need goes."""

import pytest

from moseg.schemas.recipes import Recipe, split_ref
from moseg.store import LocalStore, open_store
from moseg.workflows.engine.cues import split_cues
from moseg.workflows.stages.registry import all_tasks

CUES = {task.name for task in all_tasks() if task.is_cue}


@pytest.fixture
def segment(squares, tmp_path, moseg):
    def call(*more, store="store"):
        arguments = ("segment", squares / "squares" / "frames", "--store", tmp_path / store, "--out", tmp_path / "out")
        ran = moseg(*arguments, "--quiet", *more)
        assert ran.code == 0, ran.err
        return ran.out

    return call


def _tasks(tmp_path, store="store"):
    return {split_ref(ref)[0] for ref in open_store(str(tmp_path / store), create=False).refs()}


def test_cues_go_when_the_results_are_written(segment, tmp_path, moseg):
    segment()
    left = _tasks(tmp_path)
    assert left.isdisjoint(CUES)
    assert {"frame", "segmentation", "clustering", "ingest"} <= left
    assert ", 0 leftovers" in moseg("store", "gc", "--grace-hours", "0", "--store", tmp_path / "store", "--quiet").out
    assert "0 artifacts computed" in segment()


def test_results_without_cues_stay_when_a_collection_runs(segment, tmp_path, moseg):
    segment()
    before = list(open_store(str(tmp_path / "store")).refs())
    assert moseg("store", "gc", "--delete", "--grace-hours", "0", "--store", tmp_path / "store", "--quiet").code == 0
    assert list(open_store(str(tmp_path / "store")).refs()) == before
    assert "0 artifacts computed" in segment()


def test_other_settings_give_the_same_masks_with_and_without_cues(segment, tmp_path):
    masks = []
    for keep in ((), ("--keep-cues",)):
        segment(*keep, store=f"store{len(keep)}")
        segment("--set", "affinity.scale=0.7", *keep, store=f"store{len(keep)}")
        masks.append({path.name: path.read_bytes() for path in (tmp_path / "out" / "masks").iterdir()})
    assert masks[0] == masks[1]


def test_keep_cues_keeps_them_from_collections_too(segment, tmp_path, moseg):
    segment("--keep-cues")
    assert {"flow", "saliency"} <= _tasks(tmp_path)
    segment("--set", "affinity.scale=0.7")
    moseg("store", "gc", "--delete", "--grace-hours", "0", "--store", tmp_path / "store", "--quiet")
    assert {"flow", "saliency"} <= _tasks(tmp_path)


def test_cues_of_an_interrupted_run_go_with_those_of_the_next(segment, tmp_path):
    segment("--keep-cues")
    store = open_store(str(tmp_path / "store"))
    for name in store.pinned():
        store.unpin(name)
    for ref in list(store.refs("segmentation")):
        store.remove(ref)
    segment()
    assert _tasks(tmp_path).isdisjoint(CUES)


def test_release_spares_what_any_pin_reaches(tmp_path, put_chain):
    store, (cue, result) = put_chain
    store.pin("alone", [result], with_inputs=False)
    store.pin("live", [cue], lease_seconds=60)
    assert store.release([cue]) == 0
    store.pin("live", [result])
    assert store.release([cue]) == 0
    store.unpin("live")
    assert store.release([cue, result]) == 1
    assert list(store.refs()) == [result]


@pytest.fixture
def put_chain(tmp_path):
    store = LocalStore(tmp_path / "chain")
    cue = Recipe(task="toy", version=1)
    result = Recipe(task="toy", version=2, inputs={"cue": cue.ref})
    for recipe in (cue, result):
        store.put(recipe, {}, dims={})
    return store, (cue.ref, result.ref)


def test_leaves_behind_cues_are_kept():
    flow = Recipe(task="flow", version=2, params={"method": "dis"}, inputs={"frame0": "frame/" + "0" * 64})
    score = Recipe(task="flow", version=2, params={"method": "raft"}, inputs={"flow": flow.ref})
    recipes = {recipe.ref: recipe for recipe in (flow, score)}
    assert split_cues(recipes, [score.ref]) == ([score.ref, "frame/" + "0" * 64], [flow.ref])


def test_keep_cues_computes_those_that_an_earlier_run_did_not_keep(segment, tmp_path):
    segment()
    assert _tasks(tmp_path).isdisjoint(CUES)
    said = segment("--keep-cues")
    assert {"flow", "saliency"} <= _tasks(tmp_path)
    assert "0 artifacts computed" not in said
    assert "0 artifacts computed" in segment("--keep-cues")
