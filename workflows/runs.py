"""Opening what a command runs on: its store and its runner."""

from collections.abc import Iterator
from contextlib import closing, contextmanager

from store import open_store
from workflows.runners import open_runner
from workflows.session import Session


@contextmanager
def open_session(store: str, workers: int, scheduler: str | None, quiet: bool) -> Iterator[Session]:
    """A session on the store at `store` for the block; the runner's processes end with it."""
    opened = open_store(store)
    with open_runner(workers, scheduler) as runner, closing(Session(opened, runner, quiet)) as session:
        yield session
