"""Layout of a local store: the folders below its root, and the marker that makes a folder a root."""

import os
import uuid
from collections.abc import Iterator
from pathlib import Path

from moseg.schemas.errors import MissingStoreError, StoreChoiceError, StoreError
from moseg.store.names import CONTENT, MARKER, check_marker, is_key_in, slot


class Layout:
    """Folders of a store::

    moseg-store.json                    format marker
    objects/<task>/<ab>/<key>/          one artifact: arrays.zip, a Zarr v3 group, and its manifest
    staging/<space>-<pid>-<id>/         unfinished puts and removals
    quarantine/<task>-<key>-<id>/       damaged artifacts, each with a reason
    pins/<run>.json                     what runs need
    logs/<run>/<space>-<pid>.jsonl      what happened in a run, a file for each of its processes
    """

    def __init__(self, root: Path):
        self.root = root
        self.objects = root / "objects"
        self.staging = root / "staging"
        self.quarantine = root / "quarantine"
        self.logs = root / "logs"
        # str operations: a lookup with pathlib costs more than the stat itself
        self._objects = str(self.objects)

    def folder(self, ref: str) -> str:
        """Return the folder of an artifact; raises InputError if the reference is malformed."""
        return f"{self._objects}/{slot(ref)}"

    def refs(self, task: str | None = None) -> Iterator[str]:
        """Iterate over the references of the artifacts below this root, of one task or of all, in order."""
        for name in names_in(self.objects) if task is None else [task]:
            for prefix in names_in(self.objects / name):
                for key in names_in(self.objects / name / prefix):
                    # other entries are not artifacts
                    if is_key_in(key, prefix):
                        yield f"{name}/{key}"

    def make_folder(self, folder: str | Path) -> None:
        """Make a folder below the root, and its parents; raises FileNotFoundError if there is no root.

        Only `open_root` makes the root itself: a root that vanished is not made again without its marker.
        """
        try:
            os.mkdir(folder)
        except FileExistsError:
            return
        except FileNotFoundError:
            parent = os.path.dirname(folder)
            if parent == str(self.root):
                raise
            self.make_folder(parent)
            self.make_folder(folder)


def names_in(folder: Path) -> list[str]:
    """Return the names in a folder, sorted; none if it is not there."""
    try:
        return sorted(entry.name for entry in folder.iterdir())
    except (FileNotFoundError, NotADirectoryError):
        return []


def open_root(root: Path, *, create: bool) -> bool:
    """Check the marker of a store's root, or make a new or empty root a store; return whether it has this format.

    Raises
    ------
    StoreError
        The root is missing (and `create` is false), not writable, not a store, or of another format.
    """
    content = _read_marker(root)
    if content is None:
        if not create:
            kind = StoreChoiceError if root.exists() else MissingStoreError
            raise kind("no artifact store", where=root, expected=f"a folder with {MARKER}")
        content = _create_marker(root)
    return check_marker(content, root / MARKER)


def renew_marker(root: Path) -> None:
    """Give a store of an earlier format this one."""
    partial = root / f".{MARKER}.{uuid.uuid4().hex}"
    partial.write_bytes(CONTENT)
    partial.replace(root / MARKER)


def _read_marker(root: Path) -> bytes | None:
    try:
        return (root / MARKER).read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise StoreChoiceError(f"cannot read the artifact store: {error.strerror}", where=root) from error


def _create_marker(root: Path) -> bytes:
    partial = root / f".{MARKER}.{uuid.uuid4().hex}"
    try:
        root.mkdir(parents=True, exist_ok=True)
        # another process may be creating the same store: its partial marker is not another file
        foreign = [name for name in os.listdir(root) if not name.startswith(f".{MARKER}.")]
        if MARKER in foreign:
            return (root / MARKER).read_bytes()
        if foreign:
            raise StoreChoiceError(
                "not an artifact store",
                where=root,
                got=f"{len(foreign)} other files",
                expected="an empty folder or a store",
            )
        partial.write_bytes(CONTENT)
        partial.replace(root / MARKER)
    except StoreError:
        raise
    except OSError as error:
        raise StoreChoiceError(f"cannot create an artifact store: {error.strerror}", where=root) from error
    return CONTENT
