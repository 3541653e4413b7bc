"""A cluster as its runner sees it: its workers, and its failures as one line in place of Dask's traces."""

from asyncio import CancelledError
from collections.abc import Iterator
from concurrent.futures import CancelledError as FutureCancelledError
from contextlib import contextmanager, suppress
from typing import Protocol

from distributed import Client
from distributed.client import ClosedClientError
from distributed.comm import CommClosedError
from distributed.scheduler import KilledWorker

from moseg.schemas.errors import ClusterError, MosegError
from moseg.workflows.cluster.remote_calls import Setup
from moseg.workflows.cluster.submission_window import CallError

RESUME = "what was finished is kept, the same command goes on from there"


class Cluster(Protocol):
    """Workers, and what a runner needs of them.

    Attributes
    ----------
    setup : Setup
        The state that every call requires of its process.
    where : str
        The cluster's name in messages; a client that Dask has closed has lost its scheduler's address.
    """

    setup: Setup
    where: str

    def client(self) -> Client:
        """Return the client, its workers started."""

    def is_lost(self) -> bool:
        """Return whether the client had a connection to the scheduler and has none now."""

    def num_threads(self) -> int:
        """Return how many calls run at the same time."""

    def claim_gpus(self) -> bool:
        """Return whether a call that runs a network must wait for a GPU; raise InputError if a GPU was requested and
        there is none."""

    def admit_workers(self) -> int:
        """Check workers that have joined since, and return how many calls run at the same time; raise InputError if one
        cannot be given work."""

    def examine_workers(self) -> None:
        """Check all workers again, because a call failed for want of a module."""

    def watch(self) -> None:
        """Report that there are no workers; raise ClusterError if none will come. Called while no call finishes."""

    def close(self) -> None:
        """End what was started."""


@contextmanager
def as_cluster_errors(cluster: Cluster) -> Iterator[None]:
    """Raise the error of a call unchanged, and a failure of the cluster as ClusterError or InputError."""
    try:
        yield
    except CallError as failed:
        raise _explained(failed, cluster) from failed.reason
    except (CommClosedError, CancelledError, FutureCancelledError) as error:
        raise _gone(cluster, error) from error
    except (OSError, ClosedClientError, AttributeError) as error:
        # It comes from a store, or from the receiver of the results, if the scheduler is there. A client that Dask has
        # closed has no scheduler whose methods could be called.
        if isinstance(error, MosegError) or not cluster.is_lost():
            raise
        raise _gone(cluster, error) from error


def _explained(failed: CallError, cluster: Cluster) -> BaseException:
    stage, reason = failed.name.partition("-")[0], failed.reason
    # A worker without a module reports that, or ends when it is given the call.
    if isinstance(reason, ImportError | KilledWorker):
        # If the scheduler has ended by now, the reason stays as it is.
        with suppress(OSError, ClosedClientError, AttributeError):
            cluster.examine_workers()
    if isinstance(reason, KilledWorker):
        last = getattr(reason.last_worker, "address", reason.last_worker)
        return ClusterError(
            "workers died again and again",
            where=f"stage {stage}, call {failed.name}",
            got=f"{reason.allowed_failures + 1} workers lost while they had it, the last one {last}",
            expected=f"workers with enough memory (the usual reason): fewer of them, or --batch 1; {RESUME}",
        )
    if isinstance(reason, CancelledError | FutureCancelledError):
        return _gone(cluster, reason)
    return reason


def _gone(cluster: Cluster, error: BaseException) -> ClusterError:
    got = "a closed connection" if isinstance(error, AttributeError) else error
    expected = f"a scheduler that lives as long as the run; {RESUME}"
    return ClusterError("the scheduler is gone or dropped the work", where=cluster.where, got=got, expected=expected)
