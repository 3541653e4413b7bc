"""What became of workers or of their scheduler, in one line in place of Dask's traces."""

from asyncio import CancelledError
from collections.abc import Iterator
from concurrent.futures import CancelledError as FutureCancelledError
from contextlib import contextmanager, suppress

from distributed.client import ClosedClientError
from distributed.comm import CommClosedError
from distributed.scheduler import KilledWorker

from moseg.schemas.errors import ClusterError, MosegError
from moseg.workflows.cluster.clusters import Cluster
from moseg.workflows.cluster.submission_window import CallError

RESUME = "what was finished is kept, the same command goes on from there"


@contextmanager
def as_cluster_errors(cluster: Cluster) -> Iterator[None]:
    """Raise what a call raised as it is, and a failure of the cluster as ClusterError or InputError."""
    try:
        yield
    except CallError as failed:
        raise _explained(failed, cluster) from failed.reason
    except (CommClosedError, CancelledError, FutureCancelledError) as error:
        raise _gone(cluster, error) from error
    except (OSError, ClosedClientError, AttributeError) as error:
        # Of a store, or of whoever is told the results, while the scheduler is there. A client that Dask has closed
        # has no scheduler whose methods could be called.
        if isinstance(error, MosegError) or not cluster.is_lost():
            raise
        raise _gone(cluster, error) from error


def _explained(failed: CallError, cluster: Cluster) -> BaseException:
    stage, reason = failed.name.partition("-")[0], failed.reason
    # A worker that lacks a module says so, or ends when it is given the call.
    if isinstance(reason, ImportError | KilledWorker):
        # Where the scheduler is gone by now, the reason stands as it is.
        with suppress(OSError, ClosedClientError, AttributeError):
            cluster.examine_workers()
    if isinstance(reason, KilledWorker):
        return ClusterError(
            "workers died again and again",
            where=f"stage {stage}, call {failed.name}",
            got=f"{reason.allowed_failures + 1} workers lost while they had it, the last one {_address(reason)}",
            expected=f"workers with memory enough (the usual reason): fewer of them, or --batch 1; {RESUME}",
        )
    if isinstance(reason, CancelledError | FutureCancelledError):
        return _gone(cluster, reason)
    return reason


def _address(reason: KilledWorker) -> str:
    return str(getattr(reason.last_worker, "address", reason.last_worker))


def _gone(cluster: Cluster, error: BaseException) -> ClusterError:
    got = "a closed connection" if isinstance(error, AttributeError) else error
    expected = f"a scheduler that lives as long as the run; {RESUME}"
    return ClusterError("the scheduler is gone or dropped the work", where=cluster.where, got=got, expected=expected)
