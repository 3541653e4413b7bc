"""Writing results for the user: all of a file or nothing of it."""

import os
import tempfile
from pathlib import Path

from schemas.errors import InputError


def check_writable(path: str | Path) -> None:
    """Raise InputError now rather than after the work where a file could not be written at `path`."""
    target = Path(path)
    folder = target.parent
    if target.is_dir():
        raise InputError("cannot write a file", where=target, got="a folder", expected="a file name")
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError("cannot write", where=target, got=error.strerror or error) from error


def write_text(path: str | Path, text: str) -> None:
    """Replace the file at `path` by `text` in one step, UTF-8."""
    target = Path(path)
    check_writable(target)
    handle, staged = tempfile.mkstemp(dir=target.parent, prefix=f".{target.name}.")
    try:
        with os.fdopen(handle, "w", encoding="utf-8") as file:
            file.write(text)
        os.chmod(staged, 0o644)
        os.replace(staged, target)
    except BaseException:
        Path(staged).unlink(missing_ok=True)
        raise
