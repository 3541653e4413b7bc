"""A Dask cluster that others started, on which this program leaves nothing behind."""

import sys
from collections.abc import Callable, Iterable, Mapping

from distributed import Client

from moseg.schemas.errors import ClusterError, InputError, MosegError
from moseg.workflows.cluster.check import ClusterCheck
from moseg.workflows.cluster.connection import connect
from moseg.workflows.cluster.placement import GPU, DeclaredGpus
from moseg.workflows.cluster.remote_calls import make_setup, prepare_process
from moseg.workflows.cluster.tls_files import TlsFiles


class ExistingCluster:
    """All workers of a scheduler, those that join later included.

    Raises
    ------
    InputError
        See `connect` and `ClusterCheck`; or a worker that declares a GPU has not the device that was requested.
    ClusterError
        The scheduler ended in the meantime.
    """

    def __init__(self, scheduler: str, tls: TlsFiles, threads: int, device: str):
        self.setup = make_setup(threads, DeclaredGpus(device))
        self._device = device
        self._had_gpus = False
        self._is_waiting = False
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
        """Return whether a worker declares a GPU, or did before; see `Cluster.claim_gpus`.

        Once there was one, networks wait until another joins: on a CPU they would give other bytes.
        """
        if self._device == "cpu" or self._had_gpus:
            return self._had_gpus
        workers = self._client.scheduler_info(-1)["workers"].values()
        self._had_gpus = any(worker["resources"].get(GPU) for worker in workers)
        if self._had_gpus or self._device == "auto":
            return self._had_gpus
        raise InputError(
            "no worker declares a GPU",
            where=f"--scheduler {self._client.scheduler.address}",
            got=f"--device {self._device} and {len(workers)} workers",
            expected="dask worker --resources GPU=1, or --device cpu",
        )

    def admit_workers(self) -> int:
        """See `Cluster.admit_workers`."""
        return self._admit(self._check.check_late_workers)

    def examine_workers(self) -> None:
        """See `Cluster.examine_workers`."""
        self._check.forget_workers()
        self._admit(self._check.check_workers)

    def watch(self) -> None:
        """See `Cluster.watch`."""
        has_workers = self.is_lost() or bool(self._client.nthreads())
        if not has_workers and not self._is_waiting:
            print(f"moseg: --scheduler {self.where} has no workers any more, waiting for one", file=sys.stderr)
        self._is_waiting = not has_workers

    def close(self) -> None:
        """See `Cluster.close`."""
        self._client.close()

    def _admit(self, check: Callable[[Iterable[str]], list[str]]) -> int:
        """Prepare the workers that pass a check for the first time, and return the threads of all."""
        threads = self._client.nthreads()
        if addresses := check(threads):
            refusals = self._client.run(prepare_process, self.setup, workers=addresses, on_error="return")
            for address, refusal in refusals.items():
                # A worker that has ended in the meantime gives an OSError.
                if isinstance(refusal, OSError):
                    threads.pop(address)
                elif refusal is not None:
                    raise refusal
        return self._count(threads)

    def _count(self, threads: Mapping[str, int]) -> int:
        return sum(number for address, number in threads.items() if address not in self._check.unresponsive)
