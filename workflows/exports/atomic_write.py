"""Files that appear whole or not at all."""

import os
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from schemas.errors import InputError


@contextmanager
def blame_output(path: Path, *more: type[Exception]) -> Iterator[None]:
    """Turn a failure of the file system, or one of `more`, into an InputError that names the output."""
    try:
        yield
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
    temporary = path.with_name(f".{path.name}.{uuid.uuid4().hex}.part")
    try:
        yield temporary
        with blame_output(path):
            os.replace(temporary, path)
    finally:
        temporary.unlink(missing_ok=True)
