"""The workers that calls are sent to: processes of this machine, or a Dask cluster that is not ours."""

import sys
from collections.abc import Callable, Iterable, Mapping
from contextlib import ExitStack
from importlib.util import find_spec
from typing import Protocol

import dask
from distributed import Client, LocalCluster

from moseg.schemas.errors import ClusterError, MosegError
from moseg.workflows.cluster.check import ClusterCheck
from moseg.workflows.cluster.code_fingerprint import code_fingerprint
from moseg.workflows.cluster.connection import SHORT_LOGS, TlsFiles, connect
from moseg.workflows.cluster.placement import ForeignGpus, ForeignWorkers, OwnGpus, OwnWorkers, Plan, set_up_workers
from moseg.workflows.cluster.remote_calls import Setup, prepare_worker
from moseg.workflows.process.interrupts import defer_interrupts
from moseg.workflows.process.memory import allocation_environ
from moseg.workflows.process.threads import thread_environ
from moseg.workflows.weights.reading import PACKAGES


class Cluster(Protocol):
    """Workers, and what is to be known of them.

    Attributes
    ----------
    setup : Setup
        What every call asks of the process that runs it.
    where : str
        What messages call the cluster; a client that Dask has closed no longer knows its scheduler's address.
    """

    setup: Setup
    where: str

    def client(self) -> Client:
        """The client, its workers started."""

    def is_lost(self) -> bool:
        """Whether the client had a connection to the scheduler and has none now."""

    def num_threads(self) -> int:
        """How many calls run at the same time."""

    def claim_gpus(self) -> bool:
        """See `Gpus.claim`."""

    def admit_workers(self) -> int:
        """Look at workers that have joined since, and return how many calls run at the same time; raises InputError
        where one cannot be given work."""

    def examine_workers(self) -> None:
        """Look at all workers again, because a call failed for want of a module."""

    def close(self) -> None:
        """End what was started."""


class LocalWorkers:
    """So many processes of this machine, which start with the first call and come back where they die."""

    def __init__(self, workers: int, threads: int, device: str):
        self.setup = _setup(threads)
        self.where = f"--workers {workers}"
        self._workers = workers
        self._gpus = OwnGpus(threads, device)
        self._stack = ExitStack()
        self._client: Client | None = None

    def client(self) -> Client:
        """See `Cluster.client`."""
        if self._client is None:
            settings = {
                "distributed.nanny.pre-spawn-environ": thread_environ(self.setup.threads) | allocation_environ(),
                # Samples the stack of every worker a hundred times a second.
                "distributed.worker.profile.enabled": False,
                **SHORT_LOGS,
            }
            with defer_interrupts(), dask.config.set(settings):
                cluster = self._start()
                self._client = self._stack.enter_context(Client(self._stack.enter_context(cluster)))
                set_up_workers(self._client, self.setup.threads, OwnWorkers())
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
            # Dask's own says no more than that its nanny failed.
            reason = error.__cause__ or error
            expected = (
                "memory enough for so many, or fewer workers; in a script of your own what is run must stand below"
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
        """See `Cluster.claim_gpus`."""
        return self._gpus.claim(self.client())

    def admit_workers(self) -> int:
        """See `Cluster.admit_workers`."""
        # They are this program's own, and every call has them compare their code.
        return self._workers

    def examine_workers(self) -> None:
        """See `Cluster.examine_workers`."""

    def close(self) -> None:
        """See `Cluster.close`."""
        self._stack.close()


class ForeignCluster:
    """Whoever works for a scheduler, now or later; nothing of ours is left there.

    Raises
    ------
    InputError
        See `connect` and `ClusterCheck`; or a worker that declares a GPU lacks the device that was asked for.
    ClusterError
        The scheduler ended meanwhile.
    """

    def __init__(self, scheduler: str, tls: TlsFiles, threads: int, device: str):
        self.setup = _setup(threads, ForeignWorkers(device))
        self._gpus = ForeignGpus(device)
        self._client = connect(scheduler, tls)
        try:
            self.where = self._client.scheduler.address
            self._check = ClusterCheck(self._client)
            self._check.check_scheduler()
            if not self._admit(self._check.check_workers):
                print(f"moseg: --scheduler {scheduler} has no workers yet, waiting for one", file=sys.stderr)
        except OSError as error:
            self._client.close()
            if isinstance(error, MosegError):
                raise
            raise ClusterError("the scheduler is gone", where=f"--scheduler {scheduler}", got=error) from error
        except BaseException:
            self._client.close()
            raise

    def client(self) -> Client:
        """See `Cluster.client`."""
        return self._client

    def is_lost(self) -> bool:
        """See `Cluster.is_lost`."""
        return self._client.status != "running"

    def num_threads(self) -> int:
        """See `Cluster.num_threads`."""
        return self._count(self._client.nthreads())

    def claim_gpus(self) -> bool:
        """See `Cluster.claim_gpus`."""
        return self._gpus.claim(self._client)

    def admit_workers(self) -> int:
        """See `Cluster.admit_workers`."""
        return self._admit(self._check.check_late_workers)

    def examine_workers(self) -> None:
        """See `Cluster.examine_workers`."""
        self._check.forget_workers()
        self._admit(self._check.check_workers)

    def close(self) -> None:
        """See `Cluster.close`."""
        self._client.close()

    def _admit(self, check: Callable[[Iterable[str]], list[str]]) -> int:
        threads = self._client.nthreads()
        for address, refusal in self._prepare(check(threads)).items():
            if not isinstance(refusal, OSError):
                raise refusal
            threads.pop(address)
        return self._count(threads)

    def _count(self, threads: Mapping[str, int]) -> int:
        return sum(number for address, number in threads.items() if address not in self._check.speechless)

    def _prepare(self, addresses: list[str]) -> dict[str, Exception]:
        """Prepare new workers; what went wrong, by address."""
        if not addresses:
            return {}
        answers = self._client.run(prepare_worker, self.setup, workers=addresses, on_error="return")
        return {address: answer for address, answer in answers.items() if answer is not None}


def _setup(threads: int, plan: Plan | None = None) -> Setup:
    packages = tuple(name for name in PACKAGES if find_spec(name) is not None)
    return Setup(code_fingerprint(), threads, packages, plan)
