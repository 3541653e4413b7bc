"""The status of evaluations: while they run it counts what is done, and after them it agrees with their report."""

import json
from contextlib import closing

import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.store import open_store
from moseg.workflows.cluster.runners import SynchronousRunner
from moseg.workflows.datasets import open_dataset
from moseg.workflows.engine.session import Session
from moseg.workflows.pipelines.evaluate import evaluate
from moseg.workflows.runlog.status import RunState, read_status


class _Looks(SynchronousRunner):
    """Runner that reads the run's status after each call."""

    def __init__(self, look):
        self._look = look

    def run(self, calls, on_done):
        def done(name, result):
            on_done(name, result)
            self._look()

        super().run(calls, done)


def test_a_run_can_be_read_while_it_runs(evaluated_copy, moseg):
    store = open_store(str(evaluated_copy.store))
    dropped = [ref for task in ("segmentation", "score") for ref in store.refs(task)]
    for ref in dropped:
        store.remove(ref)
    config = PipelineConfig.model_validate({"sections": {"length": 4, "overlap": 2}})
    data = open_dataset("folder", str(evaluated_copy.root), max_side=config.max_side)
    seen = []
    with closing(
        Session(store, _Looks(lambda: seen.append(read_status(store, session.run_id))), quiet=True)
    ) as session:
        evaluate(session, data.name, [data.sequence("squares")], config, [Variant.FUSED])
    assert [status.num_done for status in seen] == list(range(1, len(dropped) + 1))
    assert {(status.state, status.num_planned) for status in seen} == {(RunState.RUNNING, len(dropped))}
    status = read_status(store, session.run_id)
    assert (status.state, status.num_done) == (RunState.FINISHED, len(dropped))
    assert sum(stage.hits for stage in status.stages) == session.reused.total()


@pytest.mark.parametrize("how", ["evaluated", "evaluated_by_workers"])
def test_the_status_of_a_run_agrees_with_its_report(request, moseg, tmp_path, how):
    _, store, _, report = request.getfixturevalue(how)
    ran = moseg("status", "latest", "--store", store, "--json", tmp_path / "status.json")
    assert ran.code == 0 and "finished" in ran.out
    status = json.loads((tmp_path / "status.json").read_text())
    assert status["state"] == "finished"
    assert status["num_done"] == status["num_planned"] == report["store"]["computed"]
    assert sum(stage["committed"] for stage in status["stages"]) == report["store"]["computed"]
    assert status["failures"] == status["quarantined"] == status["in_flight"] == []
