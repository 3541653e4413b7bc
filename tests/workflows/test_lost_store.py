"""A store that is removed is reported in one line, and no other is created in its place."""

import shutil

import numpy as np
import pytest

from moseg.schemas.errors import MissingStoreError, StoreError
from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore, open_store
from moseg.workflows.engine.execution import execute_batches, execute_ingest
from moseg.workflows.engine.ingest import IngestJob
from moseg.workflows.runlog.run_log import RunLog
from moseg.workflows.sources import SceneFrames
from moseg.workflows.stages.task import Task

RECIPE = Recipe(task="flow", version=1, params={"method": "raft"})
RUN = "20260101T000000-00000000"


def _execute(url):
    execute_batches(url, [[RECIPE]], RUN)


def _ingest(url):
    job = IngestJob("frame", SceneFrames("ball"))
    execute_ingest(url, [[(job, RECIPE)]], RUN)


@pytest.mark.parametrize("work", [_execute, _ingest])
@pytest.mark.parametrize("scheme", ["", "file://"])
def test_no_task_of_a_worker_creates_a_store(tmp_path, work, scheme):
    with pytest.raises(MissingStoreError, match=r"no artifact store in .*gone"):
        work(f"{scheme}{tmp_path / 'gone'}")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "use",
    [
        lambda store: store.put(RECIPE, {"x": np.zeros(3)}, dims={"x": ("frame",)}),
        lambda store: store.append_log(RUN, b"{}\n"),
        lambda store: store.quarantine(RECIPE.ref, "damaged"),
        lambda store: store.pin(RUN, [RECIPE.ref]),
        lambda store: store.remove(RECIPE.ref),
    ],
    ids=["put", "append_log", "quarantine", "pin", "remove"],
)
def test_an_open_store_that_was_removed_is_not_created_again(tmp_path, use):
    store = open_store(str(tmp_path / "store"))
    shutil.rmtree(tmp_path / "store")
    with pytest.raises(StoreError, match=str(tmp_path / "store")):
        use(store)
    assert list(tmp_path.iterdir()) == []


def test_a_store_that_is_removed_during_a_task_is_not_created_again(tmp_path, monkeypatch):
    def run(params, inputs, rng):
        shutil.rmtree(tmp_path / "store")
        raise RuntimeError("nothing left to read")

    monkeypatch.setattr(
        "moseg.workflows.engine.execution.find_task", lambda *_: Task("flow", "raft", version=1, run=run)
    )
    LocalStore(tmp_path / "store")
    with pytest.raises(RuntimeError, match="nothing left to read"):
        _execute(str(tmp_path / "store"))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("workers", [0, 1])
def test_a_run_whose_store_is_removed_ends_with_one_line(squares, moseg, tmp_path, monkeypatch, workers):
    # The last step of the client before the tasks start.
    monkeypatch.setattr(RunLog, "announce", lambda self: shutil.rmtree(tmp_path / "store"))
    options = ("--store", tmp_path / "store", "--out", tmp_path / "out", "--workers", workers, "--quiet")
    ran = moseg("segment", squares / "squares" / "frames", *options)
    assert (ran.code, ran.out) == (2, "")
    assert ran.err == (f"moseg: no artifact store in {tmp_path / 'store'}; expected a folder with moseg-store.json\n")
    assert not (tmp_path / "store").exists()
