"""Digests of files; pins: those of the first download of a file without a published checksum, enforced afterwards."""

import hashlib
from pathlib import Path

from pydantic import Field, ValidationError

from moseg.schemas.errors import InputError
from moseg.schemas.frozen import Frozen
from moseg.schemas.weights import PINS, Sha256, WeightsFile
from moseg.workflows.process.atomic_write import atomic_path, blame_output


class FilePin(Frozen):
    """Digest and size of what an address returned."""

    source: str
    sha256: Sha256
    size: int = Field(ge=1)


class Pins(Frozen):
    """The pins of one item.

    Attributes
    ----------
    commits : dict of str to str
        By ``<repository>@<branch>`` of the hub: the commit from which all its files are taken.
    files : dict of str to FilePin
        By name of the file.
    """

    commits: dict[str, str] = {}
    files: dict[str, FilePin] = {}

    def of(self, file: WeightsFile) -> FilePin | None:
        """Return the pin of a file; None if there is none or if it is of another address."""
        pin = self.files.get(file.name)
        return pin if pin is not None and pin.source == file.url else None

    def is_outdated(self, file: WeightsFile) -> bool:
        """Return whether a file that only its download fixes came from an address that is no longer its own."""
        return file.is_fixed_by_download and file.name in self.files and self.of(file) is None

    def without(self, file: WeightsFile) -> "Pins":
        """Return the pins without that of a file."""
        return self.model_copy(update={"files": {name: pin for name, pin in self.files.items() if name != file.name}})


def read_pins(folder: Path) -> Pins:
    """Return the pins of the item in a folder; none if nothing was pinned.

    Raises InputError if they cannot be read.
    """
    path = folder / PINS
    try:
        return Pins.model_validate_json(path.read_bytes())
    except (FileNotFoundError, NotADirectoryError):
        return Pins()
    except (OSError, ValidationError) as error:
        expected = "what a download wrote; delete the file and those beside it to fetch them anew"
        raise InputError("unreadable pins", where=path, expected=expected) from error


def write_pins(folder: Path, pins: Pins) -> None:
    """Write the pins of the item in a folder."""
    with atomic_path(folder / PINS) as temporary, blame_output(folder / PINS):
        temporary.write_text(pins.model_dump_json(indent=2) + "\n", encoding="utf-8")


_KNOWN: dict[tuple[str, int, int], str] = {}


def sha256_of(path: Path) -> str:
    """Return the hexadecimal SHA-256 of a file's bytes."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def cached_sha256(path: Path) -> str:
    """Return the same; read again in this process only if size or modification time changed."""
    stat = path.stat()
    state = (str(path.resolve()), stat.st_size, stat.st_mtime_ns)
    if state not in _KNOWN:
        _KNOWN[state] = sha256_of(path)
    return _KNOWN[state]
