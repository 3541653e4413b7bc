"""The videos in a folder: files of videos, and folders of frames."""

import os
from pathlib import Path

from moseg.schemas.errors import InputError, MissingInputError
from moseg.workflows.sources.files import IMAGE_SUFFIXES, list_files

VIDEO_SUFFIXES = (
    *(".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".mpg", ".mpeg", ".ts", ".mts", ".m2ts"),
    *(".3gp", ".flv", ".mxf", ".ogv", ".vob", ".wmv", ".y4m"),
)
"""Suffixes by which a file of a folder is taken for a video; not those of kinds that are often no video, as GIF."""
RESULTS = ("motion.json", "masks", "overlay.mp4")
"""Names of the results of `moseg segment` in a folder; the first is there if the others are."""


def list_videos(folder: str, is_required: bool = True) -> tuple[str, ...]:
    """Return the paths of the videos in a folder by name: video files and folders of images, or itself if it is one.

    What `moseg segment` left in the folder is no video.

    Raises
    ------
    MissingInputError
        There is no such folder.
    InputError
        There is no video in it, and one is required.
    """
    path = Path(os.path.abspath(folder))
    if not path.is_dir():
        raise MissingInputError("folder does not exist", where=folder, expected="a folder of videos")
    if list_files(str(path), IMAGE_SUFFIXES):
        return (str(path),)
    own = RESULTS if (path / RESULTS[0]).exists() else ()
    found = [
        str(each)
        for each in sorted(path.iterdir())
        if each.name not in own and not each.name.startswith(".") and _is_video(each)
    ]
    if not found and is_required:
        expected = f"files of {' '.join(VIDEO_SUFFIXES)}, or folders of images"
        raise InputError("no videos", where=folder, expected=expected)
    return tuple(found)


def _is_video(path: Path) -> bool:
    if path.is_dir():
        return bool(list_files(str(path), IMAGE_SUFFIXES))
    return path.suffix.lower() in VIDEO_SUFFIXES
