"""Opening what a command runs on: its store and its runner."""

import os
from collections.abc import Iterator
from contextlib import closing, contextmanager

from moseg.schemas.errors import InputError
from moseg.store import open_store
from moseg.workflows.cluster.connection import TlsFiles
from moseg.workflows.cluster.runners import open_runner
from moseg.workflows.engine.session import Session
from moseg.workflows.weights.folder import open_weights


@contextmanager
def open_session(
    store: str,
    workers: int = 0,
    scheduler: str | None = None,
    tls: TlsFiles | None = None,
    quiet: bool = False,
    device: str = "auto",
    threads: int = 1,
    batch: int | None = None,
    offline: bool = False,
    non_commercial: bool = False,
) -> Iterator[Session]:
    """A session on the store at `store`, made where there is none, for the block; the runner's processes end with it.

    Raises
    ------
    InputError
        The store, the workers, the device or the size of a batch cannot be had.
    """
    if batch is not None and batch < 1:
        raise InputError("not a number of frames", where="--batch", got=batch, expected="1 or more")
    opened = open_store(store, create=True)
    weights = open_weights(os.environ, offline=offline, allow_non_commercial=non_commercial, quiet=quiet)
    with (
        open_runner(workers, scheduler, device, threads, tls) as runner,
        closing(Session(opened, runner, quiet, weights, batch)) as session,
    ):
        yield session
