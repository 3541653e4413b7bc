"""The files of one weights item: which of them are here, and whether they are what they must be."""

import os
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from moseg.schemas.errors import InputError, MissingInputError
from moseg.schemas.weights import WeightsFile, WeightsItem
from moseg.workflows.weights.fetch_command import fetch_command
from moseg.workflows.weights.pins import cached_sha256, read_pins, sha256_of
from moseg.workflows.weights.reading import file_state, read_checkpoint

if TYPE_CHECKING:
    from moseg.tasks.networks import Checkpoint

REFUSED_SUFFIX = ".refused"


class Verdict(NamedTuple):
    """Digests of a file: `expected` is None if it is not known, `got` if the file is missing."""

    path: Path
    expected: str | None
    got: str | None

    @property
    def is_wrong(self) -> bool:
        """Return whether the file is there and differs."""
        return None not in (self.expected, self.got) and self.expected != self.got


class ItemFolder:
    """One item and the folder of its files, which each method reads anew."""

    def __init__(self, item: WeightsItem, path: Path):
        self.item = item
        self.path = path

    def missing(self) -> list[WeightsFile]:
        """Return the files that are not here, or that came from an address that is no longer the item's."""
        pins = read_pins(self.path)
        return [file for file in self.item.files if pins.is_outdated(file) or not (self.path / file.name).is_file()]

    def num_bytes(self) -> int:
        """Return the bytes of the files that are here."""
        return sum(path.stat().st_size for _, path in self._paths() if path.is_file())

    def check_sizes(self) -> None:
        """Raise InputError for a file that is here and has a wrong size."""
        pins = read_pins(self.path)
        for file in self.item.files:
            path, pin = self.path / file.name, pins.of(file)
            size = pin.size if pin is not None and file.sha256 is None else file.size
            if path.is_file() and not pins.is_outdated(file) and size not in (None, path.stat().st_size):
                raise self._refusal(file, f"{path.stat().st_size} bytes", f"{size} bytes")

    def digest(self, file: WeightsFile) -> str | None:
        """Return the SHA-256 that a file must have, else that of its bytes; None if it is not here either."""
        path, pinned = self.path / file.name, self._pinned(file)
        if pinned is None and path.is_file() and file not in self.missing():
            return _hash(path, cached_sha256)
        return pinned

    def verify(self) -> list[Verdict]:
        """Hash every file and compare it with what it must be."""
        return [Verdict(path, self._pinned(file), _hash(path)) for file, path in self._paths()]

    def refuse_wrong(self) -> None:
        """Rename every wrong file that can be fetched anew."""
        for file, verdict in zip(self.item.files, self.verify(), strict=True):
            if verdict.is_wrong and file.url is not None:
                _move_aside(verdict.path)

    def read(self, digests: Mapping[str, str]) -> "Checkpoint":
        """Return what a network is built from; see `Weights.read`."""
        names = [file.name for file in self.item.files]
        if set(digests) != set(names):
            got, expected = ", ".join(sorted(names)), ", ".join(sorted(digests))
            raise InputError("other weights files", where=f"weights {self.item.name}", got=got, expected=expected)
        states = {}
        for file, path in self._paths():
            states[path] = file_state(path) if path.is_file() else None
            got = _hash(path)
            if got is None:
                raise self.absence(file)
            if got != digests[file.name]:
                if got != (self._pinned(file) or got):
                    raise self._refusal(file, f"SHA-256 {got}", self._pinned(file))
                expected = f"{digests[file.name]}, as when the run began"
                raise InputError("another weights file", where=path, got=f"SHA-256 {got}", expected=expected)
        try:
            checkpoint = read_checkpoint(self.item, self.path)
        except InputError as error:
            if not any(file.is_fixed_by_download for file in self._concerned(error)):
                raise
            what, where, got, expected = error.parts
            expected = f"{expected}; `{fetch_command(self.item, again=True)}` gets it anew"
            raise InputError(what, where=where, got=got, expected=expected) from error
        for path, state in states.items():
            if file_state(path) != state:
                raise InputError("a weights file was written to while it was read", where=path)
        return checkpoint

    def absence(self, file: WeightsFile) -> MissingInputError:
        """Return the error of a missing file, with the command that fetches it."""
        expected = f"`{fetch_command(self.item)}`, with a network"
        if file.url is None:
            expected = "your file: its item names no address"
        return MissingInputError(
            f"weights {self.item.name} are not here", where=self.path / file.name, expected=expected
        )

    def _paths(self) -> list[tuple[WeightsFile, Path]]:
        return [(file, self.path / file.name) for file in self.item.files]

    def _pinned(self, file: WeightsFile) -> str | None:
        """Return the digest that the item gives, else that of the first download."""
        if file.sha256 is not None:
            return file.sha256
        pin = read_pins(self.path).of(file)
        return pin.sha256 if pin is not None else None

    def _concerned(self, error: InputError) -> Sequence[WeightsFile]:
        """Return the file that an error of reading names; all of them if it names none."""
        return [file for file, path in self._paths() if path == error.parts[1]] or self.item.files

    def _refusal(self, file: WeightsFile, got: str, expected: str) -> InputError:
        """Return the error of a wrong file; rename the file if it can be fetched anew."""
        path = self.path / file.name
        if file.url is not None:
            expected = f"{expected}; {_move_aside(path)}, `{fetch_command(self.item)}` gets the right one"
        return InputError("a wrong weights file", where=path, got=got, expected=expected)


def _move_aside(path: Path) -> str:
    """Rename a file so that it is not used; return what was done, for a message."""
    aside = path.with_name(path.name + REFUSED_SUFFIX)
    try:
        os.replace(path, aside)
    except OSError as error:
        return f"it could not be renamed ({error.strerror})"
    return f"it is renamed to {aside.name}"


def _hash(path: Path, hash_file: Callable[[Path], str] = sha256_of) -> str | None:
    """Return the SHA-256 of a file; None if there is no file."""
    try:
        return hash_file(path) if path.is_file() else None
    except OSError as error:
        raise InputError("unreadable weights file", where=path, got=error.strerror) from error
