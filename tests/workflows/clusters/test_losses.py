"""Workers may die at any time: the run goes on, or ends with one line that names the call at which they died."""

import json
import os
import signal
import subprocess
import sys
from types import SimpleNamespace

import dask
import pytest
from distributed.client import ClosedClientError
from distributed.comm import CommClosedError
from distributed.scheduler import KilledWorker

from moseg.schemas.errors import ClusterError, InputError, MissingStoreError
from moseg.store import open_store
from moseg.workflows.cluster import remote_calls
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.distributed_runner import DistributedRunner
from moseg.workflows.cluster.existing_cluster import ExistingCluster
from moseg.workflows.cluster.placement import AssignedAccelerators
from moseg.workflows.cluster.runners import open_runner
from moseg.workflows.cluster.submission_window import CallError, SubmissionWindow
from moseg.workflows.cluster.tls_files import TlsFiles

MOSEG = [sys.executable, "-c", "from moseg.workflows.cli import main; main()"]
DEADLINE_SEC = 600

pytestmark = pytest.mark.skipif(os.name != "posix", reason="SIGKILL is POSIX")


def _contents(folder):
    """Every artifact's arrays, by digest of their bytes, and results."""
    store = open_store(str(folder), create=False)
    manifests = {ref: store.manifest(ref) for ref in store.refs()}
    return {
        ref: ({entry.name: entry.digest for entry in manifest.arrays}, manifest.attributes)
        for ref, manifest in manifests.items()
    }


@pytest.mark.parametrize("kind", ["local", "existing"])
def test_a_run_outlives_a_worker_and_gives_the_same_bytes(kind, cluster, strike_at, evaluated, tmp_path):
    # A worker dies just before the first of its flows is there.
    step = "event == 'os.rename' and '/objects/flow/' in str(arguments[1])"
    env, killed = strike_at(step, "os.kill(os.getpid(), signal.SIGKILL)", in_worker=True)
    if kind == "existing":
        cluster.add_worker("one", path=killed.parent, has_nanny=True)
    options = ("--workers", "1") if kind == "local" else ("--scheduler", cluster.address)
    report = tmp_path / "report.json"
    arguments = [*evaluated.arguments, *options, "--store", str(tmp_path / "store"), "--json", str(report)]
    run = subprocess.run(
        [*MOSEG, *arguments], env=env, capture_output=True, text=True, check=False, timeout=DEADLINE_SEC
    )
    assert killed.exists()
    # Python itself may say that the dead process has left a semaphore.
    assert run.returncode == 0 and "moseg:" not in run.stderr and "Traceback" not in run.stderr, run.stderr
    assert json.loads(report.read_text())["rows"] == evaluated.report["rows"]
    assert _contents(tmp_path / "store") == _contents(evaluated.store)


def _fatal_call():
    # Workers cannot import this file; what is defined in a function travels as code.
    def die():
        import os
        import signal

        os.kill(os.getpid(), signal.SIGKILL)

    return Call("flow-0123", die, ())


def test_a_call_that_kills_every_worker_ends_the_run_with_its_name():
    expected = r"workers died again and again in stage flow, call flow-0123; got 2 workers lost .*memory"
    # Dask's own number is 3.
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        open_runner(workers=1) as runner,
        pytest.raises(ClusterError, match=expected),
    ):
        runner.run([_fatal_call()], lambda name, result: None)


def test_a_scheduler_that_dies_ends_the_run(start_cluster):
    cluster = start_cluster()
    cluster.add_worker("one")

    def wait():
        import time

        time.sleep(0.05)

    calls = (Call(f"slow-{number}", wait, ()) for number in range(2000))
    with open_runner(scheduler=cluster.address) as runner:
        # Dask's client waits as long for a lost scheduler as it may have waited for the first answer; none comes back.
        runner._cluster.client()._timeout = 0.5
        with pytest.raises(ClusterError, match=f"the scheduler is gone .* in {cluster.address}"):
            runner.run(calls, lambda name, result: cluster.scheduler.send_signal(signal.SIGKILL))


class _LostCluster:
    """A cluster whose client Dask has closed: it has no scheduler any more."""

    setup = None
    where = "tcp://host:8786"

    def client(self):
        return SimpleNamespace(loop=object(), scheduler=None, status="closed")

    def is_lost(self):
        return True

    def num_threads(self):
        return self.client().scheduler.ncores()

    def claim_gpus(self):
        raise ClosedClientError("Client is closed.")


def test_every_use_of_a_lost_cluster_raises_cluster_error():
    runner = DistributedRunner(_LostCluster())

    def draw():
        yield Call("light-0", abs, (-1,), needs_gpu=runner.has_gpu())

    def draw_and_ask_without_a_runner():
        yield Call("light-0", abs, (-_LostCluster().num_threads(),))

    for calls in (draw(), draw_and_ask_without_a_runner(), [Call("light-0", abs, (-1,), needs_gpu=True)]):
        with pytest.raises(ClusterError, match="the scheduler is gone or dropped the work in tcp://host:8786; got"):
            runner.run(calls, lambda name, result: None)
    for ask in (runner.has_gpu, runner.num_workers):
        with pytest.raises(ClusterError, match="the scheduler is gone"):
            ask()


def test_an_own_fault_is_not_reported_as_a_loss_of_a_cluster_that_is_there():
    cluster = _LostCluster()
    cluster.is_lost = lambda: False
    with pytest.raises(AttributeError):
        DistributedRunner(cluster).num_workers()


def _window(**methods):
    """Return a window with one submitted call, of a client with these methods."""
    window = SubmissionWindow(SimpleNamespace(loop=object(), **methods), None)
    killed = KilledWorker("flow-0", "tcp://worker:1", 3)
    future = SimpleNamespace(key="flow-0" + window._suffix, status="finished", exception=lambda: killed)
    window._futures["flow-0"] = future
    window._completed = SimpleNamespace(next_batch=lambda: [future], has_ready=lambda: True)
    return window, future


def test_a_client_that_is_closed_has_nothing_to_cancel():
    def cancel(futures):
        raise ClosedClientError("Client is closed.")

    window, _ = _window(cancel=cancel)
    window.close()
    assert len(window) == 0


def test_a_result_that_was_lost_and_fails_when_computed_again_is_the_call_s_failure():
    def gather(futures):
        future.status = "error"
        raise future.exception()

    window, future = _window(gather=gather)
    with pytest.raises(CallError) as raised:
        list(window.collect())
    assert (raised.value.name, type(raised.value.reason)) == ("flow-0", KilledWorker)


def test_a_lost_cluster_is_one_line_and_a_fault(moseg, monkeypatch):
    def lose(*arguments):
        raise ClusterError("the scheduler is gone", where="tcp://127.0.0.1:8786")

    monkeypatch.setattr("moseg.workflows.cli.app.build_command", lambda: lambda words, **options: lose())
    ran = moseg("eval")
    assert (ran.code, ran.err) == (1, "moseg: the scheduler is gone in tcp://127.0.0.1:8786\n")


def test_workers_that_end_while_they_start_are_one_line_and_a_fault(evaluated, moseg, monkeypatch, tmp_path):
    def start(**options):
        raise RuntimeError("Nanny failed to start.") from OSError("cannot allocate memory")

    monkeypatch.setattr("moseg.workflows.cluster.local_workers.LocalCluster", start)
    ran = moseg(*evaluated.arguments, "--store", tmp_path / "store", "--workers", "2")
    assert ran.code == 1
    (line,) = ran.err.splitlines()
    assert "a worker ended while it started in --workers 2" in line and "cannot allocate memory" in line


def test_a_scheduler_that_ends_before_the_first_answer_is_one_line(monkeypatch):
    def ask():
        raise CommClosedError("in <TCP>: Stream is closed")

    client = SimpleNamespace(scheduler=SimpleNamespace(address="tcp://host:8786"), close=lambda: None)
    monkeypatch.setattr("moseg.workflows.cluster.existing_cluster.connect", lambda scheduler, tls: client)
    monkeypatch.setattr(
        "moseg.workflows.cluster.existing_cluster.ClusterCheck", lambda client: SimpleNamespace(check_scheduler=ask)
    )
    with pytest.raises(ClusterError, match=r"the scheduler is gone in --scheduler tcp://host:8786; .*closed"):
        ExistingCluster("tcp://host:8786", TlsFiles(), threads=1, device="auto")


@pytest.mark.parametrize("policy", [None, AssignedAccelerators()])
def test_a_worker_of_another_machine_without_the_store_is_named(monkeypatch, policy):
    def call():
        raise MissingStoreError("no artifact store", where="/shared/store")

    monkeypatch.setattr(remote_calls, "prepare_process", lambda setup: None)
    monkeypatch.setattr(remote_calls, "get_worker", lambda: SimpleNamespace(address="tcp://node7:4000"))
    with pytest.raises(InputError, match="no artifact store in /shared/store") as caught:
        remote_calls.run_call(remote_calls.make_setup(1, policy), False, call, ())
    # Those of this machine have the same folders.
    assert ("tcp://node7:4000" in str(caught.value)) == (policy is not None)
