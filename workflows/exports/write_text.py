"""Text files, checked before the work and written whole or not at all."""

import tempfile
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.process.atomic_write import atomic_path, blame_output


def check_writable(path: Path) -> None:
    """Check before the work that a file can be written at `path`, and create its folders; raises InputError."""
    path = Path(path)
    if path.is_dir():
        raise InputError("cannot write a file", where=path, got="a folder", expected="a file name")
    check_folder(path.parent)


def check_folder(folder: Path) -> None:
    """Check that a file can be written in `folder`, which is created where it is absent; raises InputError."""
    with blame_output(folder):
        Path(folder).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            pass


def write_text(path: Path, text: str) -> None:
    """Replace the file at `path` by `text`, UTF-8; raises InputError where it cannot be written."""
    path = Path(path)
    with atomic_path(path) as temporary, blame_output(path):
        temporary.write_text(text, encoding="utf-8")
