"""Files as bytes: read, digested and listed in natural order."""

import os
import re
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import BinaryIO

from moseg.schemas.digests import digest_blocks
from moseg.schemas.errors import InputError, MissingInputError

IMAGE_SUFFIXES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff", ".webp")
BLOCK_BYTES = 2**20


@contextmanager
def open_file(path: str) -> Iterator[BinaryIO]:
    """Open a file without a buffer for the block; raise OSError, or InputError for a pipe, which is not waited for."""
    with open(path, "rb", buffering=0, opener=lambda name, flags: os.open(name, flags | os.O_NONBLOCK)) as file:
        if not stat.S_ISREG(os.fstat(file.fileno()).st_mode):
            raise InputError("not a file", where=path, got="a pipe or a device")
        yield file


def read_bytes(path: str) -> bytes:
    """Return all bytes of a file; raise MissingInputError or InputError if it cannot be read."""
    try:
        with open_file(path) as file:
            return file.read()
    except OSError as error:
        raise unreadable(path, error) from error


def digest_file(path: str) -> str:
    """Return the digest of a file's bytes, which are read in blocks so that long videos fit.

    They are not mapped into memory: a file that another program shortens meanwhile, or a disk that fails, would end
    the process by a signal.

    Raises
    ------
    MissingInputError, InputError
        The file cannot be read, or becomes longer or shorter meanwhile.
    """
    try:
        with open_file(path) as file:
            num_bytes = os.fstat(file.fileno()).st_size
            return digest_blocks("file", num_bytes, iter(partial(file.read, BLOCK_BYTES), b""))
    except InputError:
        raise
    except OSError as error:
        raise unreadable(path, error) from error
    except ValueError as error:
        expected = "a file that no other program writes to"
        raise InputError("file changes while it is read", where=path, got=error, expected=expected) from error


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


def named_stem(path: str) -> str:
    """Return the name that a file, without its last suffix, or a folder was given by, also of ``.``; of a link its own.

    A folder's name has no suffix: ``take.1`` and ``take.2`` are two names.
    """
    named = Path(os.path.abspath(path))
    return named.name if os.path.isdir(named) else named.stem


def natural_key(name: str) -> tuple[list[int | str], str]:
    """Return a sorting key by which ``2`` comes before ``10``; the name itself breaks ties (``1``, ``01``)."""
    parts = re.split(r"([0-9]+)", name)
    return [int(part) if index % 2 else part.casefold() for index, part in enumerate(parts)], name
