"""Files that appear whole or not at all."""

import os
import re
import uuid
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from moseg.schemas.errors import InputError

_PART = re.compile(r"\.[0-9a-f]{32}\.part")
"""Names of files half written, as short as they can be: that of the file itself may be as long as the system allows."""


@contextmanager
def blame_output(path: Path, *more: type[Exception]) -> Iterator[None]:
    """Turn a failure of the file system, or one of `more`, into an InputError that names the output."""
    try:
        yield
    except InputError:
        # Some are OSErrors too; they name what is wrong themselves.
        raise
    except (OSError, *more) as error:
        raise InputError("cannot write", where=path, got=getattr(error, "strerror", None) or error) from error


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """A path beside `path` to write to; renamed to it where the block ends well, removed where it does not.

    Folders are created. Failures inside the block are left as they are: only the block knows whether they come from
    writing or from what it writes.
    """
    path = Path(path)
    with blame_output(path):
        path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{uuid.uuid4().hex}.part")
    try:
        yield temporary
        with blame_output(path):
            os.replace(temporary, path)
    except BaseException:
        # What went wrong first is what counts.
        with suppress(OSError):
            temporary.unlink()
        raise


@contextmanager
def sweep_leftovers(folder: Path) -> Iterator[None]:
    """Remove, where the block ends well, what a killed run left half written in `folder`.

    Only what lay there before the block and did not change while it ran: another process may be writing its own.
    """
    with blame_output(folder):
        before = {path: _state(path) for path in _parts(folder)}
    yield
    with blame_output(folder):
        for path in _parts(folder):
            if path in before and _state(path) == before[path]:
                path.unlink(missing_ok=True)


def _parts(folder: Path) -> list[Path]:
    return [path for path in folder.iterdir() if _PART.fullmatch(path.name)] if folder.is_dir() else []


def _state(path: Path) -> tuple[int, int] | None:
    """Size and time of change; None where the file has gone meanwhile."""
    try:
        status = path.stat()
    except FileNotFoundError:
        return None
    return status.st_size, status.st_mtime_ns
