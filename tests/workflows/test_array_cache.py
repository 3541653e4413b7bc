"""The cache of the arrays that a process read or wrote, on which no result depends."""

import numpy as np
import pytest

from moseg.schemas.recipes import Recipe
from moseg.store import open_store
from moseg.workflows.engine.execution import execute_batches
from moseg.workflows.stages.array_cache import ArrayCache
from moseg.workflows.stages.inputs import ArtifactView, Inputs
from moseg.workflows.stages.registry import axes_of
from moseg.workflows.stages.task import Output, Task


def _put(store, recipe, arrays, attributes=None):
    """Store an artifact of a stage or a leaf."""
    return store.put(recipe, arrays, attributes, dims=axes_of(recipe.task, arrays))


@pytest.fixture
def store(tmp_path):
    return open_store(str(tmp_path / "store"))


def test_the_least_recently_used_arrays_are_dropped(store):
    cache = ArrayCache(limit=3 * 800)
    for name in "abc":
        cache.keep(store.url, "flow/1", {name: np.zeros(100)})
    assert cache.find(store.url, "flow/1", "a") is not None
    cache.keep(store.url, "flow/1", {"d": np.zeros(100)})
    assert [cache.find(store.url, "flow/1", name) is not None for name in "abcd"] == [True, False, True, True]


def test_an_array_beyond_the_limit_is_not_kept_and_displaces_nothing(store):
    cache = ArrayCache(limit=800)
    cache.keep(store.url, "flow/1", {"small": np.zeros(100), "large": np.zeros(101)})
    assert cache.find(store.url, "flow/1", "small") is not None
    assert cache.find(store.url, "flow/1", "large") is None


def test_kept_arrays_are_those_that_would_be_read(store):
    cache = ArrayCache(limit=10_000)
    array = np.asfortranarray(np.arange(12.0).reshape(3, 4))
    cache.keep(store.url, "flow/1", {"x": array, "zero": np.float64(3).reshape(())})
    kept = cache.find(store.url, "flow/1", "x")
    assert kept.flags.c_contiguous and np.array_equal(kept, array)
    assert cache.find(store.url, "flow/1", "zero").shape == ()
    with pytest.raises(ValueError, match="read-only"):
        kept[0] = 1


def test_stores_do_not_share_arrays(store, tmp_path):
    cache = ArrayCache(limit=10_000)
    cache.keep(store.url, "flow/1", {"x": np.zeros(3)})
    assert cache.find(open_store(str(tmp_path / "other")).url, "flow/1", "x") is None


def test_computed_arrays_are_not_read_back_from_the_store(store, monkeypatch):
    made = np.arange(24, dtype=np.uint16).reshape(2, 3, 4)
    task = Task("segmentation", "toy", version=1, run=lambda params, inputs, rng: Output({"labels": made}))
    monkeypatch.setattr("moseg.workflows.engine.execution.find_task", lambda *_: task)
    recipe = Recipe(task="segmentation", version=1, params={"method": "toy"})
    execute_batches(str(store.root), [[recipe]])
    monkeypatch.setattr("moseg.store.reading.decode_array", lambda *_: 1 // 0)
    view = Inputs(store, Recipe(task="score", version=1, inputs={"labels": recipe.ref}))["labels"]
    assert np.array_equal(view.array("labels"), made)
    assert np.array_equal(view.rows("labels", 1, 2), made[1:])


def test_what_is_derived_from_an_array_is_derived_once_for_each_variant(store):
    recipe = Recipe(task="segmentation", version=1)
    _put(store, recipe, {"labels": np.ones((2, 3, 4), np.uint16)})
    derived = []

    def derive(factor):
        def times(labels):
            derived.append(factor)
            return labels * np.uint16(factor)

        return ArtifactView(store, recipe.ref).derived("labels", f"times {factor}", times)

    found = [derive(factor) for factor in (2, 3, 2)]
    assert derived == [2, 3]
    assert [int(labels.max()) for labels in found] == [2, 3, 2]
    assert not any(labels.flags.writeable for labels in found)
    assert ArtifactView(store, recipe.ref).array("labels").max() == 1


def test_rows_outside_a_kept_array_are_rejected_as_by_the_store(store):
    recipe = Recipe(task="segmentation", version=1)
    _put(store, recipe, {"labels": np.zeros((2, 3, 4), np.uint16)})
    view = ArtifactView(store, recipe.ref)
    view.cached("labels")
    with pytest.raises(ValueError, match="rows outside the array"):
        view.rows("labels", 1, 3)


def test_dropped_arrays_are_no_longer_kept():
    cache = ArrayCache(limit=10_000)
    cache.keep("store", "flow/1", {"x": np.zeros(1000), "y": np.zeros(100)})
    cache.keep("store", "flow/2", {"x": np.zeros(100)})
    cache.drop("store", "flow/1")
    assert cache.find("store", "flow/1", "x") is None and cache.find("store", "flow/2", "x") is not None
    cache.keep("store", "flow/3", {"x": np.zeros(1100)})
    assert cache.find("store", "flow/2", "x") is not None


def test_kept_arrays_are_of_one_artifact_and_read_only(store):
    first, second = (ArtifactView(store, f"hypotheses/{number}") for number in (1, 2))
    first.keep("sums", np.arange(3))
    assert first.find_kept("sums").tolist() == [0, 1, 2] and not first.find_kept("sums").flags.writeable
    assert first.find_kept("other") is None and second.find_kept("sums") is None


def test_a_part_of_an_array_does_not_keep_the_rest_in_memory(store):
    cache = ArrayCache(limit=10_000)
    whole = np.arange(1000.0).reshape(10, 100)
    cache.keep(store.url, "flow/1", {"last": whole[-1], "whole": whole})
    assert not np.shares_memory(cache.find(store.url, "flow/1", "last"), whole)
    assert np.array_equal(cache.find(store.url, "flow/1", "last"), whole[-1])
    assert np.shares_memory(cache.find(store.url, "flow/1", "whole"), whole)
