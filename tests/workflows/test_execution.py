"""A package or memory that a task lacks on its machine is reported in one line."""

import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore
from moseg.workflows.engine.execution import execute_batches
from moseg.workflows.stages.task import Task


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
