"""Reading an artifact's files from a file system, distinguishing a lost file from a fault."""

import errno
import os
from collections.abc import Callable, Collection, Mapping
from io import FileIO
from typing import TypeVar

from moseg.schemas.errors import CorruptArtifactError, MissingArtifactError, StoreError
from moseg.store.local.layout import Layout
from moseg.store.names import MANIFEST
from moseg.store.packing import Range

_DAMAGED = (errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EIO)
_Read = TypeVar("_Read")
_LOOKS = 3
"""At a file that is not there, although its artifact's folder is."""


def read_file(folder: str, path: str, ref: str) -> bytes:
    """Return the content of one of an artifact's files.

    Raises
    ------
    MissingArtifactError
        There is no artifact.
    CorruptArtifactError
        The artifact exists, but the file is lost or cannot be read.
    """
    return _read(folder, path, ref, lambda file: file.readall())


def read_parts(folder: str, path: str, ref: str, nbytes: int, ranges: Mapping[str, Range]) -> dict[str, bytes]:
    """Return parts of one of an artifact's files, by name.

    Raises like `read_file`, and CorruptArtifactError if the file does not have `nbytes`.
    """

    def read(file: FileIO) -> dict[str, bytes]:
        number = file.fileno()
        if (found := os.fstat(number).st_size) != nbytes:
            raise CorruptArtifactError(
                "file of another length", where=f"{ref} {path}", got=found, expected=nbytes, ref=ref
            )
        return {name: _read_part(number, part) for name, part in ranges.items()}

    return _read(folder, path, ref, read)


def _read_part(number: int, part: Range) -> bytes:
    """Return a part of an open file; the system gives at most 2 GiB less a page at a time."""
    content = os.pread(number, part.nbytes, part.start)
    while len(content) < part.nbytes:
        more = os.pread(number, part.nbytes - len(content), part.start + len(content))
        if not more:
            break
        content += more
    return content


def _read(folder: str, path: str, ref: str, read: Callable[[FileIO], _Read]) -> _Read:
    """Return what `read` returns of an open file; raises what `read_file` documents for the errors of the system.

    Another process may take the artifact out of service, and a third one commit it again, between two looks: the file
    is not there, then the folder is. What is lost is so at the next look too.
    """
    looks = 0
    while True:
        looks += 1
        try:
            with open(f"{folder}/{path}", "rb", buffering=0) as file:
                return read(file)
        except CorruptArtifactError:
            # It is an OSError too, and already describes the problem.
            raise
        except OSError as error:
            if error.errno not in _DAMAGED:
                raise StoreError(f"cannot read: {error.strerror}", where=f"{ref} {path}") from error
            if not os.path.lexists(folder):
                raise MissingArtifactError("no such artifact", where=ref) from None
            if error.errno != errno.ENOENT or looks == _LOOKS:
                problem = f"unreadable file: {error.strerror}"
                raise CorruptArtifactError(problem, where=f"{ref} {path}", ref=ref) from None


def read_manifests(layout: Layout, refs: Collection[str]) -> dict[str, bytes]:
    """Return the manifest files of the artifacts that are there; empty bytes if one is unreadable."""
    found = {}
    for ref in refs:
        try:
            found[ref] = read_file(layout.folder(ref), MANIFEST, ref)
        except MissingArtifactError:
            continue
        except CorruptArtifactError:
            found[ref] = b""
    return found


def file_sizes(folder: str, prefix: str = "") -> dict[str, int]:
    """Return the relative path and size of every file under a folder; -1 if it is neither a file nor a folder."""
    found = {}
    for entry in os.scandir(folder):
        if entry.is_dir(follow_symlinks=False):
            found |= file_sizes(entry.path, f"{prefix}{entry.name}/")
        else:
            is_file = entry.is_file(follow_symlinks=False)
            found[f"{prefix}{entry.name}"] = entry.stat().st_size if is_file else -1
    return found


def folder_nbytes(folder: str) -> int:
    """Return the bytes of all files under a folder; 0 if it has vanished."""
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.lstat(f"{parent}/{name}").st_size
            except FileNotFoundError:
                continue
    return total
