"""Files as bytes: read, digested and listed in natural order."""

import mmap
import os
import re

from moseg.schemas.digests import digest_bytes
from moseg.schemas.errors import InputError, MissingInputError

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp")


def read_bytes(path: str) -> bytes:
    """Return all bytes of a file; raise MissingInputError or InputError if it cannot be read."""
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as error:
        raise unreadable(path, error) from error


def digest_file(path: str) -> str:
    """Return the digest of a file's bytes, which are mapped rather than read so that long videos fit."""
    try:
        with open(path, "rb") as file:
            if os.fstat(file.fileno()).st_size == 0:
                return digest_bytes("file", b"")
            with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as content:
                return digest_bytes("file", content)
    except OSError as error:
        raise unreadable(path, error) from error


def unreadable(path: str, error: OSError) -> InputError:
    """Return the error of a file that the operating system cannot read."""
    if isinstance(error, FileNotFoundError):
        return MissingInputError("file does not exist", where=path)
    return InputError("file cannot be read", where=path, got=error.strerror or error)


def list_files(folder: str, suffixes: tuple[str, ...]) -> tuple[str, ...]:
    """Return a folder's files with one of the lower-case `suffixes` as paths, in natural order; none is hidden.

    Raises
    ------
    MissingInputError
        The folder does not exist.
    InputError
        Two files share a stem (``7.jpg`` and ``7.png``): either may be frame 7.
    """
    try:
        names = [name for name in os.listdir(folder) if name.lower().endswith(suffixes) and not name.startswith(".")]
    except NotADirectoryError as error:
        raise InputError("not a folder", where=folder) from error
    except OSError as error:
        raise unreadable(folder, error) from error
    by_stem: dict[str, str] = {}
    for name in sorted(names):
        other = by_stem.setdefault(stem(name), name)
        if other != name:
            raise InputError("two files of one stem", where=folder, got=f"{other} and {name}", expected="one of them")
    return tuple(os.path.join(folder, name) for name in sorted(names, key=natural_key))


def stem(path: str) -> str:
    """Return a file's name without folder and last suffix."""
    return os.path.splitext(os.path.basename(path))[0]


def natural_key(name: str) -> tuple[list[int | str], str]:
    """Return a sorting key by which ``2`` comes before ``10``; the name itself breaks ties (``1``, ``01``)."""
    parts = re.split(r"([0-9]+)", name)
    return [int(part) if index % 2 else part.casefold() for index, part in enumerate(parts)], name
