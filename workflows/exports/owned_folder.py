"""Folder of files that an export writes; files that no export wrote are never overwritten or removed."""

import json
from collections.abc import Iterable
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.exports.ownership import OwnedFile
from moseg.workflows.exports.write_text import write_text
from moseg.workflows.process.atomic_write import blame_output, sweep_leftovers

LISTING = ".moseg-export.json"
"""Names of the files that an export wrote, beside them."""


class OwnedFolder:
    """The folder of one export, in which it may write files of these names.

    Used as a context: files of an earlier export that this one does not write again are removed at the end.

    Parameters
    ----------
    folder : Path
    names : iterable of str
        Files that will be written.
    listing : Path, optional
        File of their names; by default `LISTING` beside them.

    Raises
    ------
    InputError
        A file of such a name lies there that no export wrote, two frames share a name, or the folder cannot be written.
    """

    def __init__(self, folder: Path, names: Iterable[str], listing: Path | None = None):
        self.folder, self.names = Path(folder), tuple(names)
        self._listing = listing or self.folder / LISTING

    def check(self) -> frozenset[str]:
        """Check that the folder can be written, without writing, and return the names that an earlier export wrote."""
        if len(set(self.names)) != len(self.names):
            repeated = next(name for name in self.names if self.names.count(name) > 1)
            raise InputError("two frames of one name", where=self.folder, got=repeated)
        earlier = self._listed()
        for name in self.names:
            OwnedFile(self.folder / name, lambda path: path.name in earlier).check()
        return earlier

    def earlier(self) -> Path | None:
        """Return the folder if an earlier export wrote files in it."""
        return self.folder if self._listed() else None

    def __enter__(self) -> "OwnedFolder":
        earlier = self.check()
        self._swept = sweep_leftovers(self.folder)
        self._swept.__enter__()
        # Listed before they are written: after a kill the next run still recognises them as its own.
        self._list({*earlier, *self.names})
        return self

    def __exit__(self, kind, error, trace) -> None:
        if kind is None:
            with blame_output(self.folder):
                for name in self._listed() - set(self.names):
                    (self.folder / name).unlink(missing_ok=True)
            self._list(set(self.names))
        self._swept.__exit__(kind, error, trace)

    def _list(self, names: set[str]) -> None:
        write_text(self._listing, json.dumps(sorted(names), ensure_ascii=False, indent=0) + "\n")

    def _listed(self) -> frozenset[str]:
        path = self._listing
        try:
            names = json.loads(path.read_text(encoding="utf-8"))
        except FileNotFoundError:
            return frozenset()
        except (OSError, ValueError, RecursionError) as error:
            raise InputError("listing of an export cannot be read", where=path, got=error) from error
        # A name that contains a folder would let a listing reach other folders.
        if not isinstance(names, list) or not all(map(_is_file_name, names)):
            raise InputError("listing of an export cannot be read", where=path, expected="a list of file names")
        return frozenset(names)


def _is_file_name(name: object) -> bool:
    return isinstance(name, str) and name not in ("", "..") and Path(name).name == name
