"""Exclusive use of a folder by one run at a time."""

import errno
import fcntl
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from moseg.workflows.process.atomic_write import blame_output

_NO_LOCKS = (errno.ENOLCK, errno.EOPNOTSUPP, errno.EBADF, errno.EINVAL, errno.ENOSYS)
"""Errors of file systems that have no locks of folders; some NFS servers are among them."""


@contextmanager
def lock_folder(folder: Path, on_wait: Callable[[], None]) -> Iterator[None]:
    """Hold the lock of a folder for the block; it leaves no file, and ends with the process.

    Parameters
    ----------
    folder : Path
        Existing. If its file system has no locks, the block runs without one.
    on_wait : function
        Called if another process or block holds the lock, before waiting for it.

    Raises
    ------
    InputError
        The folder cannot be opened.
    """
    with blame_output(folder):
        descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        with blame_output(folder):
            _lock(descriptor, on_wait)
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int, on_wait: Callable[[], None]) -> None:
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            on_wait()
            fcntl.flock(descriptor, fcntl.LOCK_EX)
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
