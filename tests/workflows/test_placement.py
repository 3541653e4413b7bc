"""Calls that run a network go, one at a time, to a worker that has a GPU."""

import os
from itertools import pairwise
from types import SimpleNamespace

import pytest
from distributed import Client, LocalCluster

from moseg.schemas.errors import InputError
from moseg.workflows.cluster import placement
from moseg.workflows.cluster.placement import GPU, ForeignGpus, ForeignWorkers, OwnWorkers, share_out
from moseg.workflows.cluster.runners import Call, open_runner


def _calls():
    """Ten calls, every other with a network, which report where and when they ran."""

    # Workers cannot import this file; what is defined in a function travels as code.
    def observe(number, *waits):
        import os
        import time

        from moseg.workflows.process.devices import _chosen

        started = time.monotonic()
        time.sleep(0.05)
        return os.getpid(), _chosen, started, time.monotonic()

    return [Call(f"call-{number}", observe, (number,), needs_gpu=number % 2 == 1) for number in range(10)]


def _run(runner):
    """Reports of the network calls and of the others, in order of time."""
    found = {}
    runner.run(_calls(), found.__setitem__)
    assert len(found) == 10
    is_network = {call.name: call.needs_gpu for call in _calls()}
    reports = {kind: [found[name] for name in found if is_network[name] == kind] for kind in (True, False)}
    return tuple(sorted(reports[kind], key=lambda report: report[2]) for kind in (True, False))


@pytest.fixture(scope="module")
def cluster():
    """Two workers of a cluster that is not ours."""
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
def own():
    """Two local workers of a machine that has one GPU, and the devices for which GPUs were looked for."""
    asked = []

    def pretend(device):
        asked.append(device)
        # `auto` stands for the GPU: no machine lacks it, and the other worker's device is `cpu`.
        return ("auto",)

    with pytest.MonkeyPatch.context() as patch, open_runner(workers=2) as runner:
        patch.setattr(placement, "list_accelerators", pretend)
        yield runner, asked


@pytest.fixture
def declare(cluster):
    """Has the first worker declare so many GPUs, as `dask worker --resources` does; returns its process."""

    def call(num_gpus):
        async def set_resources(dask_worker):
            import os

            await dask_worker.set_resources(GPU=num_gpus)
            return os.getpid()

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
def test_an_accelerator_belongs_to_one_worker(names, accelerators, expected):
    plan = share_out(names, accelerators)
    for name in names:
        device, resources = plan.place(name, {})
        assert device == expected.get(name, "cpu")
        assert resources == ({GPU: 1} if name in expected else {})


def test_a_worker_that_declares_no_gpu_computes_on_its_cpu():
    plan = ForeignWorkers("cuda")
    assert plan.place("a", {}) == ("cpu", {})
    assert plan.place("a", {GPU: 0.0}) == ("cpu", {})
    assert plan.place("a", {GPU: 1.0}) == ("cuda", {})
    assert OwnWorkers().place("a", {}) == ("cpu", {})


@pytest.mark.parametrize("device", ["auto", "cuda"])
def test_networks_wait_for_a_gpu_that_was_there_once(device):
    workers = {"a": {"resources": {GPU: 1.0}}, "b": {"resources": {}}}
    client = SimpleNamespace(scheduler_info=lambda number: {"workers": workers})
    gpus = ForeignGpus(device)
    assert gpus.claim(client)
    del workers["a"]
    assert gpus.claim(client)


def test_a_gpu_that_joins_a_run_on_processors_is_used():
    workers = {"b": {"resources": {}}}
    client = SimpleNamespace(scheduler_info=lambda number: {"workers": workers})
    gpus = ForeignGpus("auto")
    assert not gpus.claim(client)
    workers["a"] = {"resources": {GPU: 1.0}}
    assert gpus.claim(client)


def test_nobody_asks_for_gpus_before_a_network_is_to_run(own):
    runner, asked = own
    before = list(asked)
    runner.run([Call("light", abs, (-1,))], lambda name, result: None)
    assert asked == before


def test_local_networks_never_overlap_and_run_where_the_gpu_is(own):
    runner, asked = own
    rounds = [_run(runner), _run(runner)]
    assert asked == ["auto"]
    networks = [report for network, _ in rounds for report in network]
    assert {report[:2] for report in networks} == {(networks[0][0], "auto")}
    for (_, _, _, end), (_, _, start, _) in pairwise(networks):
        assert start >= end
    for pid, device, *_ in (report for _, others in rounds for report in others):
        assert device == ("auto" if pid == networks[0][0] else "cpu")


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL is POSIX")
def test_a_worker_that_dies_at_work_comes_back_with_its_gpu(own, tmp_path):
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

    runner, _ = own
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
def test_networks_run_on_any_cpu_where_no_gpu_is_to_be_used(cluster, declare, device, num_gpus):
    declare(num_gpus)
    with open_runner(scheduler=cluster.scheduler.address, device=device) as runner:
        networks, others = _run(runner)
    assert {device for _, device, *_ in networks + others} == {"cpu"}


def test_a_gpu_that_no_worker_declares_is_refused_once_a_network_is_to_run(cluster):
    with open_runner(scheduler=cluster.scheduler.address, device="cuda") as runner:
        runner.run([Call("light", abs, (-1,))], lambda name, result: None)
        with pytest.raises(InputError, match=r"no worker declares a GPU in --scheduler tcp.* --resources GPU=1"):
            _run(runner)


def test_a_worker_that_declares_a_gpu_and_has_none_is_refused(cluster, declare):
    declare(1)
    expected = "no such device in --device; got mps"
    with pytest.raises(InputError, match=expected), open_runner(scheduler=cluster.scheduler.address, device="mps"):
        pass
