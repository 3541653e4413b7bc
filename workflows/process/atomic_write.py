"""Atomic writing: a file is written whole or not at all."""

import errno
import os
import re
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from moseg.schemas.errors import InputError, StoreError

_PART = re.compile(r"\.[0-9a-f]{32}\.part")
"""Names of temporary files, as short as possible: that of the file itself may be as long as the system allows."""

_OF_THE_DISK = (errno.ENOSPC, errno.EDQUOT, errno.EIO)
_STREAM_FOLDERS = {Path("/dev"), Path("/dev/fd"), Path("/proc/self/fd")}


@contextmanager
def blame_output(path: Path, *more: type[Exception]) -> Iterator[None]:
    """Turn a failure of the file system, or one of `more`, into an error that names the output.

    Raises
    ------
    StoreError
        The disk is full or failed, or a quota is used up: no fault of the path.
    InputError
        Anything else.
    """
    try:
        yield
    except (InputError, StoreError):
        # Some are OSErrors too; they already describe the problem.
        raise
    except (OSError, *more) as error:
        kind = StoreError if getattr(error, "errno", None) in _OF_THE_DISK else InputError
        raise kind("cannot write", where=path, got=getattr(error, "strerror", None) or error) from error


def is_stream(path: Path) -> bool:
    """Return whether a path is a pipe, a device or the like, to which one writes and which no file may replace.

    InputError is raised for a path that no file can have, such as one that is too long.
    """
    path = Path(path)
    # What these folders name may be a file, if the shell redirects to one.
    with blame_output(path):
        return (path.exists() and not path.is_file() and not path.is_dir()) or path.absolute().parent in _STREAM_FOLDERS


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Give the block a path beside `path`, renamed to it if the block succeeds and removed if it fails.

    Folders are created. A pipe or a device is refused. Failures inside the block stay as they are: here it is unknown
    whether they come from writing or from the data.
    """
    path = Path(path)
    with blame_output(path):
        if is_stream(path):
            raise InputError("cannot write a file", where=path, got="a pipe or a device", expected="a file name")
        path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{uuid.uuid4().hex}.part")
    try:
        yield temporary
        with blame_output(path):
            os.replace(temporary, path)
    except BaseException:
        # Keep the original error.
        with suppress(OSError):
            temporary.unlink()
        raise


@contextmanager
def sweep_leftovers(folder: Path) -> Iterator[None]:
    """Remove temporary files of killed runs from `folder` if the block succeeds.

    Only those that were there before the block and did not change while it ran: others may belong to a process at work.
    """
    with blame_output(folder):
        before = {path: file_state(path) for path in _parts(folder)}
    yield
    with blame_output(folder):
        for path in _parts(folder):
            if path in before and file_state(path) == before[path]:
                path.unlink(missing_ok=True)


def _parts(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if _PART.fullmatch(path.name)] if folder.is_dir() else []


def file_state(path: Path) -> tuple[int, int] | None:
    """Return the size of a file and the time of its last change; None if there is no such file."""
    try:
        status = path.stat()
    except FileNotFoundError:
        return None
    return status.st_size, status.st_mtime_ns
