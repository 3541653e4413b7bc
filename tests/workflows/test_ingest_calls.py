"""Cheap sources share a call, in batches; a file that cannot be read is the only one that is logged as failed."""

from contextlib import closing
from typing import NamedTuple

import numpy as np
import pytest

from moseg.schemas.digests import digest_json
from moseg.schemas.errors import InputError
from moseg.schemas.events import EventKind
from moseg.store import open_store
from moseg.workflows.cluster.runners import SynchronousRunner
from moseg.workflows.engine.calls import CALLS_PER_WORKER, CHEAP_PER_CALL
from moseg.workflows.engine.ingest import IngestJob
from moseg.workflows.engine.session import Session
from moseg.workflows.runlog.status import list_runs, read_events


class Labels(NamedTuple):
    """A source of the labels of as many trajectories as its number; number 3 cannot be read."""

    number: int

    def fingerprint(self):
        return digest_json("source", ["labels", self.number])

    def read(self):
        if self.number == 3:
            raise InputError("not a file of labels", where="number 3", got="nothing", expected="labels")
        return np.full(self.number + 1, 1, np.uint16)


class Recorded(SynchronousRunner):
    """Runner with a given number of workers, which keeps the calls of each run."""

    def __init__(self, workers=1):
        self.runs = []
        self._workers = workers

    def num_workers(self):
        return self._workers

    def run(self, calls, on_done):
        calls = list(calls)
        self.runs.append([call.arguments[1] for call in calls])
        super().run(calls, on_done)


def _jobs(numbers, **options):
    return [IngestJob("trajectory_labels", Labels(number), **options) for number in numbers]


def _ingest(folder, jobs, runner):
    with closing(Session(open_store(str(folder)), runner, quiet=True)) as session:
        return session.ingest(jobs)


@pytest.mark.parametrize("workers", [1, 2])
def test_cheap_jobs_share_calls_and_each_worker_has_several(tmp_path, workers):
    runner = Recorded(workers)
    jobs = _jobs(range(4, 84), is_cheap=True)
    found = _ingest(tmp_path, jobs, runner)
    (calls,) = runner.runs
    assert [len(batches) for batches in calls] == [80 // CALLS_PER_WORKER // workers] * CALLS_PER_WORKER * workers
    assert found == _ingest(tmp_path / "other", [job._replace(is_cheap=False) for job in jobs], SynchronousRunner())


def test_a_call_takes_a_limited_number_of_cheap_jobs(tmp_path):
    runner = Recorded()
    _ingest(tmp_path, _jobs(range(4, 4 + 10 * CHEAP_PER_CALL), is_cheap=True), runner)
    assert {len(batches) for batches in runner.runs[0]} == {CHEAP_PER_CALL}


def test_other_jobs_have_a_call_for_each_batch(tmp_path):
    runner = Recorded()
    jobs = [*_jobs(range(4, 44)), *_jobs(range(44, 48), batch="scene")]
    _ingest(tmp_path, jobs, runner)
    (calls,) = runner.runs
    assert [[len(batch) for batch in batches] for batches in calls] == [[1]] * 40 + [[4]]


def test_nothing_is_decoded_that_is_remembered(tmp_path):
    jobs, runner = _jobs(range(4, 24), is_cheap=True), Recorded()
    first = _ingest(tmp_path, jobs[:10], SynchronousRunner())
    assert _ingest(tmp_path, jobs, runner)[:10] == first
    decoded = [job.source.number for batches in runner.runs[0] for batch in batches for job, _ in batch]
    assert decoded == [*range(14, 24)]


def test_only_the_file_that_cannot_be_read_failed(tmp_path):
    jobs = _jobs(range(16), is_cheap=True)
    with pytest.raises(InputError, match="not a file of labels"):
        _ingest(tmp_path, jobs, SynchronousRunner())
    store = open_store(str(tmp_path))
    (run,) = list_runs(store)
    events = [event for event in read_events(store, run) if event.event != EventKind.PLANNED]
    refs = {job.recipe.ref: job.source.number for job in jobs}
    failed = [refs[event.ref] for event in events if event.event == EventKind.FAILED]
    committed = [refs[event.ref] for event in events if event.event == EventKind.COMMITTED]
    # 2 is in the same call.
    assert failed == [3] and 2 in committed and 3 not in committed
    # What was decoded is kept.
    _ingest(tmp_path, [jobs[number] for number in committed], runner := Recorded())
    assert runner.runs == [[]]
