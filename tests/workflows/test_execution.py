"""A package or memory that a task lacks is reported in one line; the arrays of a clip do not stay in memory."""

import numpy as np
import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe, leaf_recipe
from moseg.store import LocalStore
from moseg.workflows.engine.execution import execute_batches, execute_clip
from moseg.workflows.stages.array_cache import ARRAYS
from moseg.workflows.stages.task import Output, Task


class OutOfMemoryError(RuntimeError):
    """Error with the name of torch's own."""


@pytest.fixture
def execute(tmp_path, monkeypatch):
    """Return a function that executes a recipe whose task raises the given error."""

    def call(error):
        def run(params, inputs, rng):
            raise error

        monkeypatch.setattr(
            "moseg.workflows.engine.execution.find_task", lambda *_: Task("flow", "raft", version=1, run=run)
        )
        LocalStore(tmp_path / "store")
        return execute_batches(str(tmp_path / "store"), [[Recipe(task="flow", version=1, params={"method": "raft"})]])

    return call


def test_a_gpu_with_too_little_memory_is_reported_with_a_remedy(execute):
    with pytest.raises(InputError, match=r"memory does not hold it in flow by raft; .*--batch 1"):
        execute(OutOfMemoryError("CUDA out of memory"))


def test_missing_libraries_of_networks_are_reported_with_a_remedy(execute, monkeypatch):
    monkeypatch.setattr("moseg.workflows.weights.reading.find_spec", lambda name: None)
    with pytest.raises(InputError, match="networks need torch"):
        execute(ModuleNotFoundError("No module named 'torch'", name="torch"))


@pytest.mark.parametrize("fault", [RuntimeError("shape"), ModuleNotFoundError("No module named 'ours'", name="ours")])
def test_other_errors_are_raised_unchanged(execute, fault):
    with pytest.raises(type(fault)) as raised:
        execute(fault)
    assert raised.value is fault


def test_a_worker_without_access_to_the_store_creates_none(tmp_path):
    with pytest.raises(InputError, match="no artifact store"):
        execute_batches(str(tmp_path / "not shared"), [[Recipe(task="flow", version=1, params={"method": "raft"})]])
    assert list(tmp_path.iterdir()) == []


def test_the_arrays_of_a_clip_are_kept_until_its_last_recipe_only(tmp_path, monkeypatch):
    def run(params, inputs, rng):
        if "first" not in inputs:
            return Output({"flow": inputs["leaf"].cached("image").astype(np.float32)})
        assert all(ARRAYS.find(store.url, each, name) is not None for each, name in kept.items())
        return Output({"flow": inputs["first"].array("flow") + 1})

    monkeypatch.setattr(
        "moseg.workflows.engine.execution.find_task", lambda *_: Task("flow", "raft", version=1, run=run)
    )
    store = LocalStore(tmp_path / "store")
    leaf = leaf_recipe("frame", "0" * 64)
    store.put(leaf, {"image": np.ones((2, 2, 3), np.uint8)}, dims={"image": ("y", "x", "rgb")})
    first = Recipe(task="flow", version=1, params={"method": "raft"}, inputs={"leaf": leaf.ref})
    second = Recipe(task="flow", version=1, params={"method": "raft"}, inputs={"first": first.ref})
    kept = {leaf.ref: "image", first.ref: "flow"}
    reports = execute_clip(store.url, [first, second])
    assert [report.ref for report in reports] == [first.ref, second.ref]
    assert np.array_equal(store.read(second.ref, "flow"), np.full((2, 2, 3), 2))
    assert all(ARRAYS.find(store.url, ref, name) is None for ref, name in (kept | {second.ref: "flow"}).items())


def test_each_recipe_of_a_batch_draws_its_own_numbers(tmp_path, monkeypatch):
    def run(params, inputs, rng):
        return Output({"flow": rng.random((2, 3, 2)).astype(np.float32)})

    task = Task("flow", "raft", version=1, run=run)
    monkeypatch.setattr("moseg.workflows.engine.execution.find_task", lambda *_: task)
    leaves = [f"frame/{digit * 64}" for digit in "01"]
    recipes = [Recipe(task="flow", version=1, params={"method": "raft"}, inputs={"frame0": leaf}) for leaf in leaves]
    together, alone = LocalStore(tmp_path / "together"), LocalStore(tmp_path / "alone")
    execute_batches(together.url, [recipes])
    execute_batches(alone.url, [[recipe] for recipe in recipes])
    first, second = (together.read(recipe.ref, "flow") for recipe in recipes)
    assert not np.array_equal(first, second)
    for recipe in recipes:
        np.testing.assert_array_equal(together.read(recipe.ref, "flow"), alone.read(recipe.ref, "flow"))


def test_what_another_process_stored_first_is_what_others_read(tmp_path, monkeypatch):
    store, theirs = LocalStore(tmp_path / "store"), np.ones((2, 3, 2), np.float32)
    recipe = Recipe(task="flow", version=1, params={"method": "raft"})

    def run(params, inputs, rng):
        store.put(recipe, {"flow": theirs}, dims={"flow": ("y", "x", "uv")})
        return Output({"flow": 2 * theirs})

    task = Task("flow", "raft", version=1, run=run)
    monkeypatch.setattr("moseg.workflows.engine.execution.find_task", lambda *_: task)
    (report,) = execute_batches(store.url, [[recipe]])
    assert report.outcome == "lost-race" and ARRAYS.find(store.url, recipe.ref, "flow") is None
