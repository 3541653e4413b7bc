"""Only a window of the calls is submitted at a time, and no call runs before those that it waits for."""

import time
from contextlib import closing
from itertools import count
from threading import Event, Thread, Timer

import pytest
from distributed import Client, LocalCluster

from moseg.schemas.errors import ClusterError
from moseg.workflows.cluster import distributed_runner, local_workers, runners, submission_window
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.distributed_runner import DistributedRunner
from moseg.workflows.cluster.existing_cluster import ExistingCluster
from moseg.workflows.cluster.local_workers import LocalWorkers
from moseg.workflows.cluster.runners import SynchronousRunner, open_runner
from moseg.workflows.cluster.tls_files import TlsFiles

WINDOW = 32


@pytest.fixture(scope="module", params=[0, 2], ids=["synchronous", "workers"])
def runner(request):
    """Return a runner whose submission window is small."""
    with pytest.MonkeyPatch.context() as patch, open_runner(workers=request.param) as opened:
        patch.setattr(runners, "CALLS_AT_ONCE", WINDOW)
        patch.setattr(distributed_runner, "MIN_WINDOW", WINDOW)
        patch.setattr(distributed_runner, "CALLS_PER_THREAD", WINDOW // 2)
        yield opened


def _calls(number, drawn, folder=None):
    """Yield calls that wait for the one before and the tenth before; with a folder, each writes a file."""

    # Workers cannot import this file; a function defined in a function is sent as code.
    def work(number):
        from pathlib import Path

        if folder is not None:
            before = [number - step for step in (1, 10) if number >= step]
            assert all(Path(folder, str(other)).exists() for other in before), number
            Path(folder, str(number)).touch()
        return number

    for i in range(number):
        drawn.append(i)
        yield Call(f"stage{i % 3}-{i}", work, (i,), tuple(f"stage{j % 3}-{j}" for j in (i - 10, i - 1) if j >= 0))


def test_calls_are_submitted_within_the_window_and_run_in_order(runner, tmp_path):
    drawn, found, ahead = [], {}, []

    def done(name, result):
        found[name] = result
        ahead.append(len(drawn) - len(found))

    runner.run(_calls(200, drawn, str(tmp_path)), done)
    assert found == {f"stage{i % 3}-{i}": i for i in range(200)}
    assert max(ahead) < WINDOW


def test_an_endless_iterator_of_calls_ends_with_the_first_error(runner):
    def work(number):
        if number == 3 * 32:
            raise KeyError(number)

    calls = (Call(f"stage-{number}", work, (number,)) for number in count())
    done = []
    with pytest.raises(KeyError, match="96"):
        runner.run(calls, lambda name, result: done.append(name))
    assert "stage-96" not in done
    # The runner can be used again.
    runner.run([Call("stage-1", abs, (-1,))], lambda name, result: done.append(result))
    assert done[-1] == 1


def test_no_calls_start_no_workers(monkeypatch):
    monkeypatch.setattr("moseg.workflows.cluster.local_workers.LocalCluster", None)
    with open_runner(workers=2) as runner:
        runner.run([], lambda name, result: None)
        runner.run(iter(()), lambda name, result: None)
        assert runner.num_workers() == 2


def test_the_scheduler_forgets_finished_calls(monkeypatch):
    monkeypatch.setattr(distributed_runner, "MIN_WINDOW", WINDOW)
    monkeypatch.setattr(distributed_runner, "CALLS_PER_THREAD", WINDOW)
    sizes = []
    with open_runner(workers=1) as runner:

        def look(name, result):
            if name.endswith("0"):
                client = Client.current()
                scheduler = client.cluster.scheduler
                sizes.append((len(scheduler.tasks), len(client.futures), len(scheduler.task_prefixes)))

        runner.run(_calls(200, []), look)
        scheduler = Client.current().cluster.scheduler
        assert len(sizes) == 20
        # The window, and the calls that it still waits for or that were just collected.
        assert max(tasks for tasks, _, _ in sizes) <= 3 * WINDOW
        assert max(futures for _, futures, _ in sizes) <= 3 * WINDOW
        assert max(prefixes for _, _, prefixes in sizes) <= 5
    assert len(scheduler.tasks) == 0


def test_runs_in_two_threads_get_their_own_results():
    """The first run draws its second call when the second run has begun."""
    found = {"first": [], "second": []}
    has_begun, may_end = Event(), Event()

    def first_calls():
        yield Call("a-0", has_begun.wait, (60,))

    def second_calls():
        yield Call("b-0", may_end.wait, (60,))

    def second():
        SynchronousRunner().run(second_calls(), lambda name, result: found["second"].append(name))

    thread = Thread(target=second)

    def draw_first():
        thread.start()
        yield from first_calls()

    def begin():
        has_begun.set()
        may_end.set()

    Timer(0.2, begin).start()
    SynchronousRunner().run(draw_first(), lambda name, result: found["first"].append(name))
    thread.join()
    assert found == {"first": ["a-0"], "second": ["b-0"]}


def test_a_run_ends_if_no_local_worker_starts_again(monkeypatch):
    monkeypatch.setattr(submission_window, "WATCH_SECONDS", 0.1)
    monkeypatch.setattr(local_workers, "WITHOUT_WORKERS_SECONDS", 0.3)
    cluster = LocalWorkers(1, 1, "cpu")
    with closing(cluster):
        cluster.client().cluster.scale(0)
        _wait(lambda: not cluster.client().nthreads())
        with pytest.raises(ClusterError, match=r"no worker starts again in --workers 1; got none for \d+ s"):
            DistributedRunner(cluster).run([Call("stage-0", abs, (1,))], lambda name, result: None)


def test_a_run_that_waits_for_workers_of_a_cluster_says_so_once(monkeypatch, capsys):
    monkeypatch.setattr(submission_window, "WATCH_SECONDS", 0.1)
    found, said = [], []

    def is_said() -> bool:
        said.append(capsys.readouterr().err)
        return "any more" in "".join(said)

    options = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0", "silence_logs": "CRITICAL"}
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=True, **options) as held:
        cluster = ExistingCluster(held.scheduler_address, TlsFiles(), 1, "cpu")
        held.scale(0)
        _wait(lambda: not cluster.client().nthreads())
        calls = [Call("stage-0", abs, (-1,))]
        run = Thread(target=DistributedRunner(cluster).run, args=(calls, lambda name, result: found.append(result)))
        run.start()
        _wait(is_said)
        held.scale(1)
        run.join()
        cluster.close()
    assert found == [1]
    assert "".join((*said, capsys.readouterr().err)).count("has no workers any more, waiting for one") == 1


def _wait(holds) -> None:
    for _ in range(6000):
        if holds():
            return
        time.sleep(0.05)
    pytest.fail("never held")
