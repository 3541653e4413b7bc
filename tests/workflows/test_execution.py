"""What a task meets on a machine that lacks something becomes one line for the user."""

import pytest

from moseg.schemas.errors import InputError
from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore
from moseg.workflows.engine.execution import execute_batches
from moseg.workflows.stages.task import Task


class OutOfMemoryError(RuntimeError):
    """Named as torch's own."""


@pytest.fixture
def execute(tmp_path, monkeypatch):
    """Executes a recipe whose task raises the given error."""

    def call(error):
        def run(params, inputs, rng):
            raise error

        monkeypatch.setattr(
            "moseg.workflows.engine.execution.find_task", lambda *_: Task("flow", "raft", version=1, run=run)
        )
        LocalStore(tmp_path / "store")
        return execute_batches(str(tmp_path / "store"), [[Recipe(task="flow", version=1, params={"method": "raft"})]])

    return call


def test_a_gpu_that_is_too_small_is_told_with_what_helps(execute):
    with pytest.raises(InputError, match=r"memory does not hold it in flow by raft; .*--batch 1"):
        execute(OutOfMemoryError("CUDA out of memory"))


def test_a_worker_without_the_networks_libraries_is_told_how_to_get_them(execute, monkeypatch):
    monkeypatch.setattr("moseg.workflows.weights.reading.find_spec", lambda name: None)
    with pytest.raises(InputError, match="networks need torch"):
        execute(ModuleNotFoundError("No module named 'torch'", name="torch"))


@pytest.mark.parametrize("fault", [RuntimeError("shape"), ModuleNotFoundError("No module named 'ours'", name="ours")])
def test_other_faults_stay_faults(execute, fault):
    with pytest.raises(type(fault)) as raised:
        execute(fault)
    assert raised.value is fault


def test_a_worker_that_does_not_see_the_store_makes_none(tmp_path):
    with pytest.raises(InputError, match="no artifact store"):
        execute_batches(str(tmp_path / "not shared"), [[Recipe(task="flow", version=1, params={"method": "raft"})]])
    assert list(tmp_path.iterdir()) == []
