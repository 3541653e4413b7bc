"""Text files, checked before the work and written whole or not at all."""

import tempfile
from enum import StrEnum
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.process.atomic_write import atomic_path, blame_output

_HEAD_NBYTES = 4096


class TextKind(StrEnum):
    """A kind of text file, as its first characters show it."""

    PAGE = "an HTML page"
    JSON = "JSON"
    YAML = "YAML"

    def is_head(self, head: bytes) -> bool:
        """Return whether a file that begins with these bytes is of this kind, or has no text."""
        text = head.decode("utf-8", "replace").lstrip("\ufeff \t\r\n").lower()
        if "\0" in text:
            return False
        match self:
            case TextKind.PAGE:
                return text.startswith(("<!doctype html", "<html")) or not text
            case TextKind.JSON:
                return text.startswith(("{", "[")) or not text
            case TextKind.YAML:
                # A character may be cut where the head ends.
                return not text.startswith(("{", "[", "<")) and "\ufffd" not in text[:-1]


def check_replaceable(path: Path, kind: TextKind) -> None:
    """Check what `check_writable` checks, and that no file of another kind would be replaced; raises InputError.

    With one word too few or too many, the path of a report may be that of the video or of a result.
    """
    path = Path(path)
    check_writable(path)
    if path.is_file():
        with blame_output(path), path.open("rb") as file:
            head = file.read(_HEAD_NBYTES)
        if not kind.is_head(head):
            got, expected = "a file of another kind", f"{kind.value}, or another file name"
            raise InputError("a file would be replaced", where=path, got=got, expected=expected)


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
