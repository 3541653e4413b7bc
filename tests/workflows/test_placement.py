"""Calls that run a network run one at a time on a worker with a GPU."""

import os
from itertools import pairwise
from types import SimpleNamespace

import pytest
from distributed import Client, LocalCluster

from moseg.schemas.errors import InputError
from moseg.workflows.cluster import existing_cluster, local_workers
from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.placement import GPU, AssignedAccelerators, DeclaredGpus
from moseg.workflows.cluster.runners import open_runner
from moseg.workflows.cluster.tls_files import TlsFiles


def _calls():
    """Return ten calls, every other with a network, which report where and when they ran."""

    # Workers cannot import this file; a function defined in a function is sent as code.
    def observe(number, *waits):
        import os
        import time

        from moseg.workflows.process.devices import _chosen

        started = time.monotonic()
        time.sleep(0.05)
        return os.getpid(), _chosen, started, time.monotonic()

    return [Call(f"call-{number}", observe, (number,), needs_gpu=number % 2 == 1) for number in range(10)]


def _run(runner):
    """Return the reports of the network calls and of the others, in order of time."""
    found = {}
    runner.run(_calls(), found.__setitem__)
    assert len(found) == 10
    is_network = {call.name: call.needs_gpu for call in _calls()}
    reports = {kind: [found[name] for name in found if is_network[name] == kind] for kind in (True, False)}
    return tuple(sorted(reports[kind], key=lambda report: report[2]) for kind in (True, False))


@pytest.fixture(scope="module")
def cluster():
    """Start two workers of an existing cluster."""
    with (
        LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            processes=True,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",
            silence_logs="ERROR",
        ) as cluster,
        Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def local():
    """Start two local workers of a machine with one GPU; record the devices for which GPUs are looked for."""
    asked = []

    def pretend(device):
        asked.append(device)
        # `auto` stands for the GPU: every machine has it, and the other worker's device is `cpu`.
        return ("auto",)

    with pytest.MonkeyPatch.context() as patch, open_runner(workers=2) as runner:
        patch.setattr(local_workers, "list_accelerators", pretend)
        yield runner, asked


@pytest.fixture
def declare(cluster):
    """Return a function that declares GPUs of the first worker, as `dask worker --resources` does."""

    def call(num_gpus):
        async def set_resources(dask_worker):
            import os

            await dask_worker.set_resources(GPU=num_gpus)
            return os.getpid()

        # On a busy machine a worker may be on its way back to the scheduler.
        cluster.wait_for_workers(2, timeout=60)
        first = min(cluster.scheduler_info()["workers"])
        return cluster.run(set_resources, workers=[first])[first]

    yield call
    call(0)


@pytest.mark.parametrize(
    ("names", "accelerators", "expected"),
    [
        ([0, 1, 2], [], {}),
        ([0, 1, 2], ["cuda:0"], {0: "cuda:0"}),
        ([0, 1], ["cuda:0", "cuda:1", "cuda:2"], {0: "cuda:0", 1: "cuda:1"}),
    ],
)
def test_an_accelerator_belongs_to_one_worker(names, accelerators, expected, monkeypatch):
    workers = {f"tcp://{name}": {"name": name} for name in names}
    plugins = []
    cluster = local_workers.LocalWorkers(len(names), threads=1, device="auto")
    cluster._client = SimpleNamespace(
        scheduler_info=lambda number: {"workers": workers}, register_plugin=plugins.append, status="running"
    )
    monkeypatch.setattr(local_workers, "list_accelerators", lambda device: accelerators)
    assert cluster.claim_gpus() == bool(accelerators)
    policy = plugins[-1]._policy if plugins else AssignedAccelerators()
    for name in names:
        device, resources = policy.place(name, {})
        assert device == expected.get(name, "cpu")
        assert resources == ({GPU: 1} if name in expected else {})


def test_a_worker_that_declares_no_gpu_computes_on_its_cpu():
    policy = DeclaredGpus("cuda")
    assert policy.place("a", {}) == ("cpu", {})
    assert policy.place("a", {GPU: 0.0}) == ("cpu", {})
    assert policy.place("a", {GPU: 1.0}) == ("cuda", {})
    assert AssignedAccelerators().place("a", {}) == ("cpu", {})


@pytest.fixture
def connect(monkeypatch):
    """Return a function that connects to a cluster whose workers are in the given dict."""

    def call(workers, device):
        client = SimpleNamespace(
            scheduler=SimpleNamespace(address="tcp://host:8786"),
            scheduler_info=lambda number: {"workers": workers},
            nthreads=lambda: dict.fromkeys(workers, 1),
        )
        check = SimpleNamespace(check_scheduler=lambda: None, check_workers=lambda threads: [], unresponsive=set())
        monkeypatch.setattr(existing_cluster, "connect", lambda scheduler, tls: client)
        monkeypatch.setattr(existing_cluster, "ClusterCheck", lambda client: check)
        return existing_cluster.ExistingCluster("tcp://host:8786", TlsFiles(), threads=1, device=device)

    return call


@pytest.mark.parametrize("device", ["auto", "cuda"])
def test_networks_wait_for_a_gpu_once_a_worker_had_one(connect, device):
    workers = {"a": {"resources": {GPU: 1.0}}, "b": {"resources": {}}}
    cluster = connect(workers, device)
    assert cluster.claim_gpus()
    del workers["a"]
    assert cluster.claim_gpus()


def test_a_gpu_that_joins_a_run_on_cpus_is_used(connect):
    workers = {"b": {"resources": {}}}
    cluster = connect(workers, "auto")
    assert not cluster.claim_gpus()
    workers["a"] = {"resources": {GPU: 1.0}}
    assert cluster.claim_gpus()


def test_gpus_are_not_looked_for_before_a_network_runs(local):
    runner, asked = local
    before = list(asked)
    runner.run([Call("light", abs, (-1,))], lambda name, result: None)
    assert asked == before


def test_local_networks_never_overlap_and_run_where_the_gpu_is(local):
    runner, asked = local
    rounds = [_run(runner), _run(runner)]
    assert asked == ["auto"]
    networks = [report for network, _ in rounds for report in network]
    assert {report[:2] for report in networks} == {(networks[0][0], "auto")}
    for (_, _, _, end), (_, _, start, _) in pairwise(networks):
        assert start >= end
    for pid, device, *_ in (report for _, others in rounds for report in others):
        assert device == ("auto" if pid == networks[0][0] else "cpu")


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL is POSIX")
def test_a_worker_that_dies_during_a_task_restarts_with_its_gpu(local, tmp_path):
    def die_once(path):
        import os
        import signal

        from moseg.workflows.process.devices import _chosen

        try:
            with open(path, "x") as note:
                note.write(str(os.getpid()))
        except FileExistsError:
            return os.getpid(), _chosen
        os.kill(os.getpid(), signal.SIGKILL)

    runner, _ = local
    calls = [*_calls()[:4], Call("dies-once", die_once, (str(tmp_path / "dead"),)), *_calls()[4:]]
    reports = {}
    runner.run([call._replace(needs_gpu=True) for call in calls], reports.__setitem__)
    assert len(reports) == 11
    assert {device for _, device, *_ in reports.values()} == {"auto"}
    assert reports["dies-once"][0] != int((tmp_path / "dead").read_text())


def test_networks_go_to_the_worker_that_declares_a_gpu(cluster, declare):
    pid = declare(1)
    with open_runner(scheduler=cluster.scheduler.address) as runner:
        networks, _ = _run(runner)
    assert {report[:2] for report in networks} == {(pid, "auto")}


@pytest.mark.parametrize(("device", "num_gpus"), [("auto", 0), ("cpu", 1)])
def test_networks_run_on_any_cpu_if_no_gpu_may_be_used(cluster, declare, device, num_gpus):
    declare(num_gpus)
    with open_runner(scheduler=cluster.scheduler.address, device=device) as runner:
        networks, others = _run(runner)
    assert {device for _, device, *_ in networks + others} == {"cpu"}


def test_a_gpu_that_no_worker_declares_is_rejected_before_a_network_runs(cluster):
    with open_runner(scheduler=cluster.scheduler.address, device="cuda") as runner:
        runner.run([Call("light", abs, (-1,))], lambda name, result: None)
        with pytest.raises(InputError, match=r"no worker declares a GPU in --scheduler tcp.* --resources GPU=1"):
            _run(runner)


def test_a_worker_that_declares_a_gpu_and_has_none_is_rejected(cluster, declare):
    declare(1)
    expected = "no such device in --device; got mps"
    with pytest.raises(InputError, match=expected), open_runner(scheduler=cluster.scheduler.address, device="mps"):
        pass
