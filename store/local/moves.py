"""Staging an artifact's files and moving them into place with one rename.

A process that is killed leaves a staging folder, never a visible artifact. Nothing is flushed to the disk on the way:
after a power loss a committed folder may hold short, empty or zeroed files. Lengths, checksums and the seal find each
of these on reading, so such an artifact is quarantined and computed again; it is never served. Flushing the files and
folders of one small artifact was measured at 20 ms to 30 ms (ext4, virtual disk), against 1.5 ms for the whole put.
"""

import errno
import os
import shutil
import uuid
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path

from moseg.schemas.errors import StoreError
from moseg.schemas.recipes import split_ref
from moseg.store.local.files import read_manifests
from moseg.store.local.layout import Layout
from moseg.store.names import MANIFEST, REASON
from moseg.store.outcomes import PutOutcome
from moseg.store.owners import owned_name


def commit(layout: Layout, ref: str, files: Mapping[str, bytes | memoryview], manifest: bytes) -> PutOutcome:
    """Write an artifact's files, its manifest last, and rename their folder into place.

    Raises StoreError where the file system refuses (no permission, disk full).
    """
    try:
        staged = new_staging(layout)
        try:
            _write_files(staged, files)
            _write(f"{staged}/{MANIFEST}", manifest)
            return _move(layout, staged, layout.folder(ref))
        finally:
            # after a commit nothing is left under this name
            shutil.rmtree(staged, ignore_errors=True)
    except OSError as error:
        raise StoreError(f"cannot write to the artifact store: {error.strerror}", where=layout.root) from error


def new_staging(layout: Layout) -> str:
    """A new folder under ``staging/`` whose name says which process owns it."""
    staged = f"{layout.staging}/{owned_name()}"
    try:
        os.mkdir(staged)
    except FileNotFoundError:
        layout.staging.mkdir(exist_ok=True)
        os.mkdir(staged)
    return staged


def _write_files(folder: str, files: Mapping[str, bytes | memoryview]) -> None:
    made = {""}
    for path, content in files.items():
        parent = path.rpartition("/")[0]
        if parent not in made:
            os.mkdir(f"{folder}/{parent}")
            made.add(parent)
        _write(f"{folder}/{path}", content)


def _write(path: str, content: bytes | memoryview) -> None:
    with open(path, "xb") as file:
        file.write(content)


def _move(layout: Layout, staged: str, target: str) -> PutOutcome:
    try:
        try:
            os.rename(staged, target)
        except FileNotFoundError:
            layout.make_folder(os.path.dirname(target))
            os.rename(staged, target)
    except OSError as error:
        if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
            return PutOutcome.LOST_RACE
        raise
    return PutOutcome.COMMITTED


def quarantine(layout: Layout, ref: str, reason: bytes) -> bool:
    """Move an artifact to ``quarantine/``, beside the reason; False where it is gone already.

    The reason is written first and the move is one rename, so an artifact is never half in service. Several processes
    may quarantine the same artifact: one moves it.
    """
    folder = layout.folder(ref)
    task, key = split_ref(ref)
    slot = layout.quarantine / f"{task}-{key}-{uuid.uuid4().hex}"
    try:
        layout.make_folder(slot)
        (slot / REASON).write_bytes(reason)
        try:
            os.rename(folder, slot / "artifact")
        except FileNotFoundError:
            shutil.rmtree(slot, ignore_errors=True)
            return False
    except OSError as error:
        raise StoreError(f"cannot quarantine an artifact: {error.strerror}", where=layout.root, got=ref) from error
    return True


class LocalTrash:
    """A staging folder with a tree of artifacts; see `moseg.store.backend.Trash`."""

    def __init__(self, layout: Layout):
        self.taken: set[str] = set()
        self._layout = layout
        try:
            self._aside = Layout(Path(new_staging(layout)))
        except OSError as error:
            raise self._fault(error) from error

    def read_manifests(self, refs: Collection[str]) -> dict[str, bytes]:
        """Manifests of artifacts that were taken."""
        return read_manifests(self._aside, refs)

    def take(self, refs: Iterable[str]) -> None:
        """Move artifacts aside."""
        for ref in refs:
            if self._rename(self._layout.folder(ref), self._aside.folder(ref)):
                self.taken.add(ref)

    def give_back(self, refs: Iterable[str]) -> None:
        """Move artifacts back."""
        for ref in refs:
            self._rename(self._aside.folder(ref), self._layout.folder(ref))
            self.taken.discard(ref)

    def empty(self) -> None:
        """Delete the staging folder."""
        shutil.rmtree(self._aside.root, ignore_errors=True)

    def _rename(self, source: str, target: str) -> bool:
        try:
            self._layout.make_folder(os.path.dirname(target))
            os.rename(source, target)
        except OSError as error:
            # gone already, or computed again meanwhile
            if os.path.lexists(source) and not os.path.lexists(target):
                raise self._fault(error) from error
            return False
        return True

    def _fault(self, error: OSError) -> StoreError:
        return StoreError(f"cannot take artifacts out of service: {error.strerror}", where=self._layout.root)
