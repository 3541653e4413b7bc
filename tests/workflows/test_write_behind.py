"""Outputs are stored while the next task computes; only the time differs."""

import threading

import numpy as np
import pytest

from moseg.schemas.errors import StoreError
from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore, PutOutcome
from moseg.workflows.engine.write_behind import MAX_WAITING, WriteBehind
from moseg.workflows.stages.inputs import ArtifactView
from moseg.workflows.stages.task import Output

FLOW = np.arange(24, dtype=np.float32).reshape(3, 4, 2)


def _flow(number):
    return Recipe(task="flow", version=1, params={"number": number})


class SlowStore:
    """Local store whose puts wait for `gate`, and fail if `failure` is set."""

    def __init__(self, root):
        self._store = LocalStore(root)
        self.gate = threading.Event()
        self.failure = None

    def put(self, *arguments, **options):
        self.gate.wait(600)
        if self.failure is not None:
            raise self.failure
        return self._store.put(*arguments, **options)

    def __getattr__(self, name):
        return getattr(self._store, name)


@pytest.fixture
def store(tmp_path):
    return SlowStore(tmp_path / "store")


@pytest.fixture
def reported():
    return []


def test_a_put_does_not_wait_for_the_store_and_all_are_reported_in_order(store, reported):
    with WriteBehind(store, reported.append) as behind:
        for number in range(MAX_WAITING):
            behind.put(_flow(number), Output({"flow": FLOW + number}), seconds=number)
        assert reported == [] and not store.has(_flow(0).ref)
        assert behind.has(_flow(0).ref)
        store.gate.set()
    assert [(put.recipe, put.seconds, put.outcome.result()) for put in reported] == [
        (_flow(number), number, PutOutcome.COMMITTED) for number in range(MAX_WAITING)
    ]
    assert np.array_equal(store.read(_flow(1).ref, "flow"), FLOW + 1)


def test_at_most_max_waiting_outputs_wait(store, reported):
    with WriteBehind(store, reported.append) as behind:
        threading.Timer(0.05, store.gate.set).start()
        for number in range(MAX_WAITING + 1):
            behind.put(_flow(number), Output({"flow": FLOW}), seconds=0.0)
        assert reported[0].recipe == _flow(0) and reported[0].outcome.done()


def test_a_read_waits_for_the_put_of_its_artifact(store, reported):
    with WriteBehind(store, reported.append) as behind:
        behind.put(_flow(0), Output({"flow": FLOW}, {"count": 3}), seconds=0.0)
        threading.Timer(0.05, store.gate.set).start()
        view = ArtifactView(behind, _flow(0).ref)
        assert view.shape("flow") == FLOW.shape
        assert np.array_equal(view.rows("flow", 1, 2), FLOW[1:2])


def test_attributes_are_read_before_they_are_stored_and_belong_to_their_reader(store, reported):
    with WriteBehind(store, reported.append) as behind:
        behind.put(_flow(0), Output({"flow": FLOW}, {"counts": [3]}), seconds=0.0)
        view = ArtifactView(behind, _flow(0).ref)
        view.attributes["counts"].append(4)
        assert view.attributes == {"counts": [3]} and not store.has(_flow(0).ref)
        store.gate.set()
    assert store.attributes(_flow(0).ref) == {"counts": [3]}


def _put_and_read(store):
    with WriteBehind(store, lambda put: put.outcome.result()) as behind:
        behind.put(_flow(0), Output({"flow": FLOW}), seconds=0.0)
        behind.read(_flow(0).ref, "flow")


def _put_and_fail(store, report):
    with WriteBehind(store, report) as behind:
        behind.put(_flow(0), Output({"flow": FLOW}), seconds=0.0)
        threading.Timer(0.05, store.gate.set).start()
        raise ZeroDivisionError


def test_a_read_raises_the_failure_of_its_put(store, reported):
    store.failure = StoreError("no space left")
    store.gate.set()
    with pytest.raises(StoreError, match="no space"):
        _put_and_read(store)


def test_outputs_before_a_failure_are_stored_and_reported(store, reported):
    with pytest.raises(ZeroDivisionError):
        _put_and_fail(store, reported.append)
    assert store.has(_flow(0).ref) and len(reported) == 1


def test_a_failed_put_does_not_hide_the_failure_before_it(store):
    store.failure = StoreError("no space left")
    with pytest.raises(ZeroDivisionError):
        _put_and_fail(store, lambda put: put.outcome.result())


def test_what_was_stored_is_reported_although_another_put_is_impossible(store, reported):
    def report(put):
        put.outcome.result()
        reported.append(put.recipe)

    def work():
        with WriteBehind(store, report) as behind:
            behind.put(_flow(0), Output({"flow": FLOW}, {"mean": np.float32(1)}), seconds=0.0)
            behind.put(_flow(1), Output({"flow": FLOW}), seconds=0.0)
            store.gate.set()
            raise KeyError("of the work")

    with pytest.raises(KeyError, match="of the work"):
        work()
    assert reported == [_flow(1)]
