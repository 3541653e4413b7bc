"""The videos in a folder: files of videos, and folders of frames."""

import os
from pathlib import Path

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources.files import IMAGE_SUFFIXES, list_files

VIDEO_SUFFIXES = (".mp4", ".mov", ".m4v", ".avi", ".mkv", ".webm", ".mpg", ".mpeg", ".ogv", ".wmv")


def list_videos(folder: str) -> tuple[str, ...]:
    """Return the paths of the videos in a folder by name: video files and folders of images, or itself if it is one.

    Raises
    ------
    MissingInputError
        There is no such folder.
    InputError
        There is no video in it.
    """
    path = Path(os.path.abspath(folder))
    if not path.is_dir():
        raise MissingInputError("folder does not exist", where=folder, expected="a folder of videos")
    if list_files(str(path), IMAGE_SUFFIXES):
        return (str(path),)
    found = [
        str(each)
        for each in sorted(path.iterdir())
        if (each.is_dir() and list_files(str(each), IMAGE_SUFFIXES)) or each.suffix.lower() in VIDEO_SUFFIXES
    ]
    if not found:
        expected = f"files of {' '.join(VIDEO_SUFFIXES)}, or folders of images"
        raise InputError("no videos", where=folder, expected=expected)
    return tuple(found)
