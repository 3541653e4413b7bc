"""Text files, checked before the work and written whole or not at all; and text for pipes."""

import json
import re
import tempfile
from enum import StrEnum
from pathlib import Path
from types import NoneType

import yaml

from moseg.schemas.errors import InputError
from moseg.workflows.process.atomic_write import atomic_path, blame_output, is_stream

_HEAD_NBYTES = 2**18
_PAGE = re.compile("<(!doctype )?html", re.IGNORECASE)


class TextKind(StrEnum):
    """A kind of text file, as its first characters show it."""

    PAGE = "an HTML page"
    JSON = "JSON"
    YAML = "YAML"

    def is_head(self, head: bytes) -> bool:
        """Return whether a file that begins with these bytes is of this kind, or has no text."""
        text = head.decode("utf-8", "replace").lstrip("\ufeff \t\r\n")
        if "\0" in text:
            return False
        match self:
            case TextKind.PAGE:
                return not text or (text.startswith("<") and _PAGE.search(text) is not None)
            case TextKind.JSON:
                return not text or text.startswith(("{", "["))
            case TextKind.YAML:
                return _is_mapping(text) and not _is_json(text)


def _is_mapping(text: str) -> bool:
    """Return whether text is YAML of names and values, or has none of them."""
    try:
        return isinstance(yaml.safe_load(text), dict | NoneType)
    except (yaml.YAMLError, ValueError, RecursionError):
        # A date that does not exist is a ValueError.
        return False


def _is_json(text: str) -> bool:
    # Most JSON is YAML too.
    try:
        json.loads(text)
    except ValueError:
        return False
    return True


def check_replaceable(path: Path, kind: TextKind) -> None:
    """Check what `check_writable` checks, and that no file of another kind would be replaced; raises InputError.

    With one word too few or too many, the path of a report may be that of the video or of a result.
    """
    path = Path(path)
    check_writable(path)
    if path.is_file() and not is_stream(path):
        with blame_output(path), path.open("rb") as file:
            head = file.read(_HEAD_NBYTES)
        if not kind.is_head(head):
            got, expected = "a file of another kind", f"{kind.value}, or another file name"
            raise InputError("a file would be replaced", where=path, got=got, expected=expected)


def check_writable(path: Path) -> None:
    """Check before the work that a file can be written at `path`, and create its folders; raises InputError."""
    path = Path(path)
    if is_stream(path):
        return
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
    """Replace the file at `path` by `text`, UTF-8, or write it to a pipe; raises InputError where it cannot be."""
    path = Path(path)
    if is_stream(path):
        with blame_output(path), path.open("a", encoding="utf-8") as stream:
            stream.write(text)
        return
    with atomic_path(path) as temporary, blame_output(path):
        temporary.write_text(text, encoding="utf-8")
