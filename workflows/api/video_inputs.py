"""Videos that a command line names: files, folders of frames, folders of videos, patterns, and standard input."""

import glob
import os
import re
import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from typing import NamedTuple

from moseg.schemas.errors import InputError, MissingInputError, StoreError
from moseg.workflows.sources.files import IMAGE_SUFFIXES, list_files, named_stem, natural_key
from moseg.workflows.sources.video_folder import list_videos

STANDARD_INPUT = "-"
_ADDRESS = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+://")
_NAMED_STANDARD_INPUT = "stdin"


class NamedVideo(NamedTuple):
    """One video to segment.

    Attributes
    ----------
    path : str
        Of a video file or a folder of frames, or `STANDARD_INPUT`.
    name : str
    is_one_of_several : bool
        Whether its results go into a folder of its name below the one given, and not into that one itself.
    """

    path: str
    name: str
    is_one_of_several: bool


def find_videos(words: Sequence[str]) -> tuple[NamedVideo, ...]:
    """Return the videos that words name, each once, in their order.

    A folder without images stands for the videos in it, and a word with ``*``, ``?`` or ``[`` that is no path for what
    fits it.

    Raises
    ------
    InputError
        A word is an address, fits nothing or only images, or two videos have one name.
    """
    paths = [(path, is_group) for word in words for path, is_group in _paths_of(word)]
    # Links to one file are several videos: each is called as it was named.
    unique: dict[str, str] = {}
    for path, _ in paths:
        unique.setdefault(os.path.abspath(path), path)
    is_several = len(unique) > 1 or any(is_group for _, is_group in paths)
    _check_not_images([path for path, is_group in paths if not is_group])
    videos = tuple(NamedVideo(path, _name_of(path), is_several) for path in unique.values())
    for name, group in groupby(sorted(videos, key=lambda video: video.name), lambda video: video.name):
        first, *others = group
        if others:
            got, expected = f"{first.path} and {others[0].path}", "one call for each, with a folder of its own by --out"
            raise InputError(f"two videos called {name!r}", got=got, expected=expected)
    return videos


def _paths_of(word: str) -> Iterator[tuple[str, bool]]:
    """Yield the paths that a word stands for, each with whether the word stands for a group."""
    if word == STANDARD_INPUT:
        yield word, False
    elif not word.strip():
        raise InputError("no video named", got=repr(word), expected="a video file, or a folder of frames")
    elif os.path.isdir(word):
        videos = () if list_files(word, IMAGE_SUFFIXES) else list_videos(word, is_required=False)
        # Without any, it is opened as a folder of frames, which reports what is missing.
        yield from ((path, True) for path in videos) if videos else ((word, False),)
    elif os.path.lexists(word):
        yield word, False
    elif _ADDRESS.match(word):
        expected = "a file (download it first: curl -LO URL)"
        raise InputError("an address, from which nothing is read", got=word, expected=expected)
    elif glob.has_magic(word):
        yield from ((path, True) for path in _fitting(word))
    else:
        yield word, False


def _fitting(pattern: str) -> list[str]:
    """Return the paths that fit a pattern, in natural order; raises InputError if none does, or only images do."""
    found = sorted(glob.glob(os.path.expanduser(pattern), recursive=True), key=natural_key)
    if not found:
        raise MissingInputError("nothing fits the pattern", got=pattern, expected="the path of a video, or of several")
    _check_not_images(found)
    return found


def _check_not_images(paths: list[str]) -> None:
    """Raise InputError if there are several paths and some of them are images: a video is their folder."""
    images = [path for path in paths if path.lower().endswith(IMAGE_SUFFIXES) and not os.path.isdir(path)]
    if len(paths) > 1 and images:
        got = f"{len(images)} images such as {images[0]}"
        folder = os.path.dirname(images[0]) or "."
        raise InputError("images in place of a video", got=got, expected=f"their folder ({folder})")


def _name_of(path: str) -> str:
    return _NAMED_STANDARD_INPUT if path == STANDARD_INPUT else named_stem(path)


@contextmanager
def opened(video: NamedVideo) -> Iterator[str]:
    """Give the path of a video for the block: standard input is kept in a temporary file, as videos are read twice.

    Raises
    ------
    InputError
        Standard input is a terminal, or empty.
    StoreError
        The temporary file cannot be written.
    """
    if video.path != STANDARD_INPUT:
        yield video.path
        return
    expected = "the bytes of a video file (cat VIDEO | moseg segment -)"
    if sys.stdin is None or sys.stdin.isatty():
        raise InputError("no video on standard input", got="a terminal", expected=expected)
    with tempfile.TemporaryDirectory(prefix="moseg-", ignore_cleanup_errors=True) as folder:
        path = os.path.join(folder, _NAMED_STANDARD_INPUT)
        try:
            with open(path, "wb") as file:
                shutil.copyfileobj(sys.stdin.buffer, file)
        except OSError as error:
            raise StoreError("cannot keep standard input", where=path, got=error.strerror or error) from error
        if not os.path.getsize(path):
            raise InputError("no video on standard input", got="nothing", expected=expected)
        yield path
