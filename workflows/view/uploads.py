"""Videos that are dropped into the page: each becomes a file of its own in the output folder."""

import re
import unicodedata
from collections.abc import AsyncIterator
from contextlib import suppress
from itertools import count
from pathlib import Path

from moseg.schemas.errors import InputError
from moseg.workflows.process.amounts import size
from moseg.workflows.process.atomic_write import atomic_path, blame_output
from moseg.workflows.sources.video_folder import VIDEO_SUFFIXES

MAX_BYTES = 16 * 2**30
"""Of one video."""
FOLDER = "input"
"""In the output folder."""
LONGEST_STEM = 80
_NOT_OF_A_NAME = re.compile(r"[^\w.+-]+")


def plain_name(given: str) -> str:
    """Return a file name of letters, digits and ``._+-`` for a video that a page calls `given`.

    Raises
    ------
    InputError
        It does not end as the name of a video does.
    """
    last = re.split(r"[/\\]", unicodedata.normalize("NFC", given))[-1]
    stem, dot, suffix = last.rpartition(".")
    suffix = f"{dot}{suffix}".lower()
    if suffix not in VIDEO_SUFFIXES:
        expected = f"a name that ends with {' or '.join(sorted(VIDEO_SUFFIXES))}"
        raise InputError("not a video by its name", got=repr(last[:LONGEST_STEM]), expected=expected)
    return (_NOT_OF_A_NAME.sub("_", stem).strip("._-")[:LONGEST_STEM] or "video") + suffix


async def receive_video(parts: AsyncIterator[bytes], given: str, out: Path, max_bytes: int = MAX_BYTES) -> Path:
    """Write a video that comes in parts, whole or not at all, and return its path.

    No file is replaced: of two videos of one name, the second one gets a number.

    Raises
    ------
    InputError
        Its name is not that of a video, it is too large or empty, or it cannot be written.
    """
    name = plain_name(given)
    path = _reserve(Path(out) / FOLDER, name)
    num_bytes = 0
    try:
        with atomic_path(path) as temporary, blame_output(path):
            with temporary.open("xb") as file:
                async for part in parts:
                    num_bytes += len(part)
                    if num_bytes > max_bytes:
                        raise InputError("a video that is too large", got=f"more than {size(max_bytes)}", where=name)
                    file.write(part)
            if not num_bytes:
                raise InputError("an empty file", where=name, expected="a video")
    except BaseException:
        with suppress(OSError):
            path.unlink()
        raise
    return path


def _reserve(folder: Path, name: str) -> Path:
    """Create an empty file of a name that no other has, and return its path: two uploads may run at a time."""
    with blame_output(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for number in count(1):
            path = folder / (name if number == 1 else f"{Path(name).stem}-{number}{Path(name).suffix}")
            with suppress(FileExistsError):
                path.touch(exist_ok=False)
                return path


def remove_video(path: Path) -> None:
    """Remove a video that was received and cannot be opened, and its folder if nothing else is in it."""
    # What cannot be removed stays; the page has the reason why the video was refused.
    with suppress(OSError):
        path.unlink()
        path.parent.rmdir()
