"""The store on a local (or mounted) file system."""

import os
import shutil
import uuid
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path

from moseg.schemas.errors import StoreError
from moseg.store.backend_store import BackendStore
from moseg.store.local import logs
from moseg.store.local.files import file_sizes, folder_nbytes, read_file, read_files, read_manifests
from moseg.store.local.layout import Layout, open_root
from moseg.store.local.moves import LocalTrash, commit, quarantine
from moseg.store.names import MANIFEST
from moseg.store.outcomes import PutOutcome
from moseg.store.owners import ABANDONED_SECONDS, is_abandoned


class LocalBackend:
    """Artifacts in folders that appear and vanish by one rename; see `moseg.store.backend.Backend`.

    An artifact's files lie beside its manifest, so the name of their place is always empty.
    """

    def __init__(self, root: Path):
        self._layout = Layout(root)

    @property
    def url(self) -> str:
        """The root's absolute path."""
        return str(self._layout.root)

    def has(self, ref: str) -> bool:
        """Whether the artifact's folder is in place: one stat."""
        return os.path.isdir(self._layout.folder(ref))

    def present(self, refs: Iterable[str]) -> set[str]:
        """Those of the references whose folders are in place: one stat each."""
        return {ref for ref in refs if self.has(ref)}

    def refs(self, task: str | None = None) -> Iterator[str]:
        """References in order."""
        return self._layout.refs(task)

    def committed(self) -> dict[str, float]:
        """Times at which the artifacts' folders were written; renames leave them as they are."""
        return {ref: _modified(self._layout.folder(ref)) for ref in self.refs()}

    def nbytes(self, refs: Collection[str]) -> dict[str, int]:
        """Bytes of all files in the artifacts' folders."""
        return {ref: folder_nbytes(self._layout.folder(ref)) for ref in refs}

    def commit(self, ref: str, files: Mapping[str, bytes | memoryview], seal: Callable[[str], bytes]) -> PutOutcome:
        """Stage the files and the manifest and move them into place with one rename."""
        return commit(self._layout, ref, files, seal(""))

    def read_manifest(self, ref: str) -> bytes:
        """The manifest file."""
        return read_file(self._layout.folder(ref), MANIFEST, ref)

    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        """The manifest files of several artifacts."""
        return read_manifests(self._layout, refs)

    def read_files(self, ref: str, payload: str, paths: Iterable[str]) -> dict[str, bytes]:
        """Files of an artifact's folder."""
        return read_files(self._layout.folder(ref), paths, ref)

    def file_sizes(self, ref: str, payload: str) -> dict[str, int]:
        """Sizes of the files of an artifact's folder."""
        return file_sizes(self._layout.folder(ref), ref)

    def quarantine(self, ref: str, reason: bytes) -> bool:
        """Move an artifact's folder to ``quarantine/``."""
        return quarantine(self._layout, ref, reason)

    def place(self, ref: str, payload: str) -> str:
        """The artifact's folder."""
        return self._layout.folder(ref)

    def new_trash(self) -> LocalTrash:
        """A staging folder for artifacts that are to be deleted."""
        return LocalTrash(self._layout)

    def leftovers(self, now: float, before: float) -> dict[str, int]:
        """Folders of dead processes under ``staging/``, old ones under ``quarantine/``, and records half written.

        Their names are relative to the root.
        """
        staged = _folders(self._layout.staging)
        found = [folder for folder in staged if is_abandoned(folder.name, now - _modified(folder))]
        found += [folder for folder in _folders(self._layout.quarantine) if _modified(folder) <= before]
        root = self._layout.root
        partials = [path for path in sorted(root.glob("*/*.partial")) if now - _modified(path) > ABANDONED_SECONDS]
        sizes = {path.relative_to(root).as_posix(): _size(path) for path in partials}
        return sizes | {folder.relative_to(root).as_posix(): folder_nbytes(str(folder)) for folder in found}

    def discard(self, leftovers: Iterable[str]) -> None:
        """Delete such folders and files."""
        for name in leftovers:
            path = self._layout.root / name
            shutil.rmtree(path, ignore_errors=True)
            with suppress(OSError):
                path.unlink()

    def write_record(self, path: str, content: bytes, purpose: str) -> None:
        """Write a small file beside its place and rename it."""
        target = self._layout.root / path
        partial = target.with_name(f"{target.name}.{uuid.uuid4().hex}.partial")
        try:
            target.parent.mkdir(exist_ok=True)
            partial.write_bytes(content)
            partial.replace(target)
        except OSError as error:
            # what cannot be deleted now is a leftover
            with suppress(OSError):
                partial.unlink(missing_ok=True)
            raise StoreError(f"cannot {purpose}: {error.strerror}", where=target) from error

    def read_record(self, path: str) -> bytes | None:
        """Content of a small file."""
        target = self._layout.root / path
        try:
            return target.read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            raise StoreError(f"cannot read: {error.strerror}", where=target) from error

    def read_records(self, folder: str) -> dict[str, bytes]:
        """The JSON files of a folder."""
        names = [f"{folder}/{path.name}" for path in sorted((self._layout.root / folder).glob("*.json"))]
        found = {name: self.read_record(name) for name in names}
        return {name: content for name, content in found.items() if content is not None}

    def delete_record(self, path: str, purpose: str) -> bool:
        """Delete a small file."""
        target = self._layout.root / path
        try:
            target.unlink()
        except FileNotFoundError:
            return False
        except OSError as error:
            raise StoreError(f"cannot {purpose}: {error.strerror}", where=target) from error
        return True

    def append_log(self, run_id: str, lines: bytes) -> None:
        """Append to this process's file of the log."""
        logs.append_log(self._layout, run_id, lines)

    def read_log(self, run_id: str) -> list[bytes]:
        """The lines of all files of the log."""
        return logs.read_log(self._layout, run_id)

    def logs(self) -> dict[str, float]:
        """Times of change of the logs' files."""
        return logs.logs(self._layout)

    def remove_log(self, run_id: str) -> bool:
        """Delete the log's folder."""
        return logs.remove_log(self._layout, run_id)


class LocalStore(BackendStore):
    """Artifacts in a folder.

    Parameters
    ----------
    root : path
        A store, or with `create` an empty or new folder to make one of.

    Raises
    ------
    StoreError
        `root` is not a store of this format, or cannot be made one.
    """

    def __init__(self, root: Path | str, create: bool = True):
        self.root = Path(root).absolute()
        open_root(self.root, create=create)
        super().__init__(LocalBackend(self.root))


def _folders(parent: Path) -> list[Path]:
    return sorted(parent.iterdir()) if parent.is_dir() else []


def _size(path: Path) -> int:
    """Bytes of a file; none of one that is gone meanwhile."""
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0


def _modified(path: str | Path) -> float:
    """Seconds since the epoch; minus infinity for what is gone meanwhile."""
    try:
        return os.stat(path).st_mtime
    except FileNotFoundError:
        return float("-inf")
