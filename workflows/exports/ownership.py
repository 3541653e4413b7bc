"""Ownership of files: moseg replaces only those that bear its mark."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import av

from moseg.schemas.errors import InputError
from moseg.workflows.exports.motion_json import read_motion
from moseg.workflows.process.atomic_write import blame_output
from moseg.workflows.sources.numpy_file import ARCHIVE_ERRORS
from moseg.workflows.sources.pillow_image import PILLOW_ERRORS, open_quietly
from moseg.workflows.sources.video_file import METADATA_ERRORS

MARK = "moseg"
"""The ``Software`` text of a mask, the ``comment`` of an overlay, the comment of an archive."""
ANNOTATIONS_INFO = {"contributor": MARK}
"""First entries of the ``info`` of moseg's annotations."""

_ANNOTATIONS_START = json.dumps({"info": ANNOTATIONS_INFO}).removesuffix("}}").encode()
_ANOTHER_FOLDER = "another output folder, or this one without such files"


class OwnedFile(NamedTuple):
    """One file that will be written.

    Attributes
    ----------
    path : Path
    is_own : callable
        Of the path of a file that exists, whether moseg wrote it.
    """

    path: Path
    is_own: Callable[[Path], bool]

    def check(self) -> None:
        """Raise InputError where a file exists that moseg did not write, or where none can have this name."""
        if exists(self.path) and not self.is_own(self.path):
            raise InputError("a file not known as moseg's own", where=self.path, expected=_ANOTHER_FOLDER)

    def earlier(self) -> Path | None:
        """Return the path if moseg wrote such a file before."""
        return self.path if exists(self.path) and self.is_own(self.path) else None


def exists(path: Path) -> bool:
    """Return whether `path` exists; raises InputError where no file can have the name, such as one that is too long."""
    with blame_output(path):
        try:
            path.stat()
        except FileNotFoundError:
            return False
    return True


def is_own_mask(path: Path) -> bool:
    """Return whether a PNG bears the mark, which ground truth lacks and most image editors do not keep."""
    try:
        with open_quietly(path) as image:
            return image.info.get("Software") == MARK
    except PILLOW_ERRORS:
        return False


def is_own_overlay(path: Path) -> bool:
    """Return whether a video (mp4, mov, webm) bears the mark."""
    try:
        demuxer = "matroska" if path.suffix == ".webm" else "mp4"
        with av.open(f"file:{path}", format=demuxer, metadata_errors=METADATA_ERRORS) as container:
            # Matroska writes the names of its tags in capitals.
            return MARK in (container.metadata.get("comment"), container.metadata.get("COMMENT"))
    except (av.FFmpegError, OSError, ValueError):
        return False


def is_own_summary(path: Path) -> bool:
    """Return whether a JSON file is a summary of motions: no other program writes exactly these fields."""
    try:
        read_motion(path)
    except InputError:
        return False
    return True


def is_own_archive(path: Path) -> bool:
    """Return whether an archive of arrays bears the mark."""
    try:
        with zipfile.ZipFile(path) as archive:
            return archive.comment == MARK.encode()
    except ARCHIVE_ERRORS:
        return False


def is_own_annotations(path: Path) -> bool:
    """Return whether a JSON file of annotations begins with the mark."""
    try:
        with path.open("rb") as file:
            return file.read(len(_ANNOTATIONS_START)) == _ANNOTATIONS_START
    except OSError:
        return False
