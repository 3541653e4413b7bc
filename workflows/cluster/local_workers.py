"""Worker processes of this machine."""

import gc
import time
from contextlib import ExitStack
from importlib import import_module

import dask
from distributed import Client, LocalCluster, Status, WorkerPlugin

from moseg.schemas.errors import ClusterError
from moseg.workflows.cluster.clusters import RESUME
from moseg.workflows.cluster.connection import SHORT_LOGS
from moseg.workflows.cluster.placement import AssignedAccelerators, PlacementPolicy
from moseg.workflows.cluster.remote_calls import make_setup
from moseg.workflows.process.devices import list_accelerators, set_device
from moseg.workflows.process.interrupts import defer_interrupts
from moseg.workflows.process.resources import allocation_environ, pin_threads, thread_environ

CALM = {"distributed.admin.tick.interval": "1s", "distributed.admin.system-monitor.interval": "2s"}
"""Scheduler, workers and their guards measure the delay of their event loops and their use of the machine this often,
for the dashboard. Dask's 20 ms and 0.5 s wake each of them fifty times a second while workers compute."""


WITHOUT_WORKERS_SECONDS = 120.0
"""Time without any worker after which a run ends; a worker starts in some seconds."""


class LocalWorkers:
    """A number of processes of this machine, which start with the first call and are restarted if they die."""

    def __init__(self, workers: int, threads: int, device: str):
        self.setup = make_setup(threads)
        self.where = f"--workers {workers}"
        self._workers = workers
        self._device = device
        # Found out when the first network is to run: that imports torch.
        self._has_gpus: bool | None = None
        self._stack = ExitStack()
        self._client: Client | None = None
        self._without_since: float | None = None

    def client(self) -> Client:
        """See `Cluster.client`."""
        if self._client is None:
            settings = {
                "distributed.nanny.pre-spawn-environ": thread_environ(self.setup.threads) | allocation_environ(),
                # Samples the stack of every worker a hundred times a second.
                "distributed.worker.profile.enabled": False,
                **CALM,
                **SHORT_LOGS,
            }
            with defer_interrupts(), dask.config.set(settings):
                cluster = self._start()
                self._client = self._stack.enter_context(Client(self._stack.enter_context(cluster)))
                self._client.register_plugin(WorkerSetup(self.setup.threads, AssignedAccelerators()))
        return self._client

    def _start(self) -> LocalCluster:
        try:
            return LocalCluster(
                n_workers=self._workers,
                threads_per_worker=1,
                processes=True,
                host="127.0.0.1",
                dashboard_address="127.0.0.1:0",
                silence_logs="CRITICAL",
            )
        except RuntimeError as error:
            # Dask's own message only reports that its nanny failed.
            reason = error.__cause__ or error
            expected = (
                "enough memory for all, or fewer workers; in a script of your own the code must stand below"
                " if __name__ == '__main__':"
            )
            raise ClusterError(
                "a worker ended while it started", where=self.where, got=reason, expected=expected
            ) from error

    def is_lost(self) -> bool:
        """See `Cluster.is_lost`."""
        return self._client is not None and self._client.status != "running"

    def num_threads(self) -> int:
        """See `Cluster.num_threads`."""
        return self._workers

    def claim_gpus(self) -> bool:
        """Give one GPU of this machine to each of the first workers; see `Cluster.claim_gpus`."""
        if self._has_gpus is None:
            client, accelerators = self.client(), list_accelerators(self._device)
            if accelerators:
                names = sorted(worker["name"] for worker in client.scheduler_info(-1)["workers"].values())
                policy = AssignedAccelerators(dict(zip(names, accelerators, strict=False)))
                client.register_plugin(WorkerSetup(self.setup.threads, policy))
            self._has_gpus = bool(accelerators)
        return self._has_gpus

    def admit_workers(self) -> int:
        """See `Cluster.admit_workers`."""
        # They belong to this program, and every call has them compare their code.
        return self._workers

    def examine_workers(self) -> None:
        """See `Cluster.examine_workers`."""

    def watch(self) -> None:
        """See `Cluster.watch`."""
        if self._client is None or self.is_lost():
            return
        now = time.monotonic()
        if self._client.nthreads():
            self._without_since = None
        elif self._without_since is None:
            self._without_since = now
        elif now - self._without_since >= WITHOUT_WORKERS_SECONDS:
            # Dask starts a worker again and again that dies before it has joined.
            expected = f"enough memory and disk for workers to start; {RESUME}"
            got = f"none for {now - self._without_since:.0f} s"
            raise ClusterError("no worker starts again", where=self.where, got=got, expected=expected)

    def close(self) -> None:
        """See `Cluster.close`."""
        self._stack.close()


class WorkerSetup(WorkerPlugin):
    """A plugin that sets the threads and the device of every local worker, also of a restarted one."""

    name = "moseg-worker"

    def __init__(self, threads: int, policy: PlacementPolicy):
        self._threads = threads
        self._policy = policy

    async def setup(self, worker):
        pin_threads(self._threads)
        # So that the first call need not wait for it.
        import_module("moseg.workflows.engine.execution")
        placement = self._policy.place(worker.name, worker.state.total_resources)
        set_device(placement.device)
        if placement.resources:
            await worker.set_resources(**placement.resources)
            # The scheduler looks for calls that wait for resources when a worker starts to run, which a worker that was
            # restarted after a crash did before it had any.
            worker.status = Status.paused
            worker.status = Status.running

    def teardown(self, worker):
        # The interpreter would search all modules for unreachable objects before it ends, in up to half a second for
        # which the client waits.
        gc.freeze()
