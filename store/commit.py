"""Staging an artifact's files and moving them into place with one rename.

A process that is killed leaves a staging folder, never a visible artifact. Nothing is flushed to the disk on the way:
after a power loss a committed folder may hold short, empty or zeroed files. Lengths, checksums and the seal find each
of these on reading, so such an artifact is quarantined and computed again; it is never served. Flushing the files and
folders of one small artifact was measured at 20 ms to 30 ms (ext4, virtual disk), against 1.5 ms for the whole put.
"""

import errno
import os
import shutil
from collections.abc import Mapping

from moseg.schemas.errors import StoreError
from moseg.store.layout import Layout
from moseg.store.names import MANIFEST
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
