"""The store on a local (or mounted) file system."""

import os
import shutil
import uuid
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import suppress
from pathlib import Path

from moseg.schemas.errors import MissingArtifactError, StoreError
from moseg.schemas.recipes import split_ref
from moseg.store.backend_store import BackendStore
from moseg.store.local.files import file_sizes, folder_nbytes, read_file, read_manifests, read_parts
from moseg.store.local.layout import Layout, open_root, renew_marker
from moseg.store.local.logs import LocalLogs
from moseg.store.local.moves import LocalTrash, commit
from moseg.store.names import MANIFEST, REASON
from moseg.store.outcomes import PutOutcome
from moseg.store.owners import ABANDONED_SECONDS, is_abandoned
from moseg.store.packing import Range


class LocalStore(LocalLogs, BackendStore):
    """Artifacts in folders of a file system, each of which appears and vanishes by one rename.

    An artifact's files lie beside its manifest, so the name of their place is always empty.

    Parameters
    ----------
    root : path
        A store or, with `create`, an empty or new folder that becomes one.

    Raises
    ------
    StoreError
        `root` is not a store of this format, or cannot become one.
    """

    def __init__(self, root: Path | str, create: bool = True):
        self.root = Path(root).absolute()
        self._is_current = open_root(self.root, create=create)
        self._layout = Layout(self.root)

    @property
    def url(self) -> str:
        return str(self.root)

    def has(self, ref: str) -> bool:
        return os.path.isdir(self._layout.folder(ref))

    def present(self, refs: Iterable[str]) -> set[str]:
        return {ref for ref in refs if self.has(ref)}

    def refs(self, task: str | None = None) -> Iterator[str]:
        return self._layout.refs(task)

    def committed(self) -> dict[str, float]:
        # a rename does not change a folder's time
        return {ref: _modified(self._layout.folder(ref)) for ref in self.refs()}

    def touch(self, refs: Iterable[str]) -> None:
        for ref in refs:
            # it is gone, or the store is read-only
            with suppress(OSError):
                os.utime(self._layout.folder(ref))

    def free_nbytes(self) -> int | None:
        try:
            return shutil.disk_usage(self.root).free
        except OSError:
            return None

    def nbytes(self, refs: Collection[str]) -> dict[str, int]:
        return {ref: folder_nbytes(self._layout.folder(ref)) for ref in refs}

    def commit(self, ref: str, files: Mapping[str, bytes | memoryview], seal: Callable[[str], bytes]) -> PutOutcome:
        if not self._is_current:
            try:
                renew_marker(self.root)
            except OSError as error:
                raise StoreError(f"cannot write to the artifact store: {error.strerror}", where=self.root) from error
            self._is_current = True
        return commit(self._layout, ref, files, seal(""))

    def read_manifest(self, ref: str) -> bytes:
        return read_file(self._layout.folder(ref), MANIFEST, ref)

    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        return read_manifests(self._layout, refs)

    def read_files(self, ref: str, payload: str, paths: Iterable[str]) -> dict[str, bytes]:
        folder = self._layout.folder(ref)
        return {path: read_file(folder, path, ref) for path in paths}

    def read_ranges(
        self, ref: str, payload: str, path: str, nbytes: int, ranges: Mapping[str, Range]
    ) -> dict[str, bytes]:
        return read_parts(self._layout.folder(ref), path, ref, nbytes, ranges)

    def file_sizes(self, ref: str, payload: str) -> dict[str, int]:
        try:
            found = file_sizes(self._layout.folder(ref))
        except FileNotFoundError:
            raise MissingArtifactError("no such artifact", where=ref) from None
        found.pop(MANIFEST, None)
        return found

    def payload_place(self, ref: str, payload: str) -> str:
        return self._layout.folder(ref)

    def move_to_quarantine(self, ref: str, reason: bytes) -> bool:
        """Move an artifact's folder to ``quarantine/``, beside the reason; return False if it is gone already.

        The reason is written first and the move is one rename, so an artifact is never half in service. Several
        processes may quarantine the same artifact: one moves it.
        """
        folder = self._layout.folder(ref)
        task, key = split_ref(ref)
        slot = self._layout.quarantine / f"{task}-{key}-{uuid.uuid4().hex}"
        try:
            self._layout.make_folder(slot)
            (slot / REASON).write_bytes(reason)
            try:
                os.rename(folder, slot / "artifact")
            except FileNotFoundError:
                shutil.rmtree(slot, ignore_errors=True)
                return False
        except OSError as error:
            raise StoreError(f"cannot quarantine an artifact: {error.strerror}", where=self.root, got=ref) from error
        return True

    def new_trash(self) -> LocalTrash:
        return LocalTrash(self._layout)

    def restore_abandoned(self, now: float) -> None:
        for folder in self._abandoned(now):
            trash = LocalTrash(self._layout, folder)
            trash.restore(trash.out_of_service())

    def leftovers(self, now: float, before: float) -> dict[str, int]:
        """Return folders of dead processes under ``staging/``, old ones under ``quarantine/``, and partial records."""
        abandoned = self._abandoned(now)
        found = [folder for folder in abandoned if not LocalTrash(self._layout, folder).out_of_service()]
        found += [folder for folder in _folders(self._layout.quarantine) if _modified(folder) <= before]
        partials = [path for path in sorted(self.root.glob("*/*.partial")) if now - _modified(path) > ABANDONED_SECONDS]
        sizes = {path.relative_to(self.root).as_posix(): _size(path) for path in partials}
        return sizes | {folder.relative_to(self.root).as_posix(): folder_nbytes(str(folder)) for folder in found}

    def _abandoned(self, now: float) -> list[Path]:
        """Return the folders under ``staging/`` that no process will finish."""
        staged = _folders(self._layout.staging)
        return [folder for folder in staged if is_abandoned(folder.name, now - _modified(folder))]

    def discard(self, leftovers: Iterable[str]) -> None:
        for name in leftovers:
            path = self.root / name
            shutil.rmtree(path, ignore_errors=True)
            with suppress(OSError):
                path.unlink()

    def write_record(self, path: str, content: bytes, purpose: str) -> None:
        target = self.root / path
        partial = target.with_name(f"{target.name}.{uuid.uuid4().hex}.partial")
        try:
            target.parent.mkdir(exist_ok=True)
            with open(partial, "wb") as file:
                file.write(content)
                file.flush()
                # A record without its bytes, as a power loss may leave it, would be refused for ever.
                os.fsync(file.fileno())
            partial.replace(target)
        except OSError as error:
            # a partial file that cannot be deleted now is a leftover
            with suppress(OSError):
                partial.unlink(missing_ok=True)
            raise StoreError(f"cannot {purpose}: {error.strerror}", where=target) from error

    def read_record(self, path: str) -> bytes | None:
        target = self.root / path
        try:
            return target.read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            raise StoreError(f"cannot read: {error.strerror}", where=target) from error

    def read_records(self, folder: str) -> dict[str, bytes]:
        names = [f"{folder}/{path.name}" for path in sorted((self.root / folder).glob("*.json"))]
        found = {name: self.read_record(name) for name in names}
        return {name: content for name, content in found.items() if content is not None}

    def delete_record(self, path: str, purpose: str) -> bool:
        target = self.root / path
        try:
            target.unlink()
        except FileNotFoundError:
            return False
        except OSError as error:
            raise StoreError(f"cannot {purpose}: {error.strerror}", where=target) from error
        return True


def _folders(parent: Path) -> list[Path]:
    return sorted(parent.iterdir()) if parent.is_dir() else []


def _size(path: Path) -> int:
    """Return the bytes of a file; 0 if it has vanished."""
    try:
        return path.stat().st_size
    except FileNotFoundError:
        return 0


def _modified(path: str | Path) -> float:
    """Return the time of the last change, seconds since the epoch; minus infinity if the path has vanished."""
    try:
        return os.stat(path).st_mtime
    except FileNotFoundError:
        return float("-inf")
