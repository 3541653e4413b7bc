"""OpenCV's decoding of images, of which not a word goes to standard error."""

import atexit
import fcntl
import os
import re
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from threading import Lock
from typing import TypeVar

import cv2
import numpy as np


def decode_quietly(content: bytes, flags: int) -> tuple[np.ndarray | None, list[str]]:
    """What OpenCV decodes, and what the decoders below it have to complain of.

    Parameters
    ----------
    content : bytes
        Of the whole file.
    flags : int
        OpenCV's ``IMREAD_*``.

    Returns
    -------
    image : (y, x) or (y, x, channel), or None
        Colours in OpenCV's order; None where OpenCV cannot decode the bytes.
    complaints : list of str
        Lines of libpng and libjpeg.
    """
    return listen_to(partial(_decode, content, flags))


def _decode(content: bytes, flags: int) -> np.ndarray | None:
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        return cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error:
        return None
    finally:
        cv2.utils.logging.setLogLevel(level)


Result = TypeVar("Result")

_STDERR = 2
_READ_BYTES = 1 << 16
_COMPLAINT = re.compile(
    rb"(?:libpng error|libpng warning|Corrupt JPEG data|Inconsistent progression sequence|Invalid SOS parameters"
    rb"|Premature end of JPEG file|Unknown Adobe color transform|Warning: unknown JFIF revision)[^\n]*\n?"
)
"""What libpng or libjpeg say, to the end of the line. The line may begin with what another thread left unfinished."""


class _Ear:
    """A file that takes the place of standard error, and what of it was read.

    There is one for all decoding of a process: a write that another thread began before standard error was put back may
    end after that, and is found in the file later.
    """

    def __init__(self):
        self.lock = Lock()
        self._file: int | None = None
        self._num_read = 0

    def open(self) -> int:
        """Descriptor of the file: in memory where there is such a thing, for a machine may have no temporary folder."""
        if self._file is None:
            if hasattr(os, "memfd_create"):
                self._file = os.memfd_create("decoder", os.MFD_CLOEXEC)
            else:
                with tempfile.TemporaryFile() as file:
                    self._file = os.dup(file.fileno())
            # Threads that print at the same time must not write over each other.
            fcntl.fcntl(self._file, fcntl.F_SETFL, fcntl.fcntl(self._file, fcntl.F_GETFL) | os.O_APPEND)
        return self._file

    def read(self) -> bytes:
        """What was printed and not read yet."""
        if self._file is None:
            return b""
        pieces = []
        # By position: reading on would move the place at which other threads write.
        while piece := os.pread(self._file, _READ_BYTES, self._num_read):
            pieces.append(piece)
            self._num_read += len(piece)
        return b"".join(pieces)


_EAR = _Ear()


def listen_to(decode: Callable[[], Result]) -> tuple[Result, list[str]]:
    """What `decode` returns, and the lines that it made libpng or libjpeg print.

    These are kept from standard error, also where `decode` raises. What another thread prints meanwhile is passed on a
    little later, and what it decodes by other means is taken for `decode`'s. What a process prints that another thread
    starts meanwhile, which inherits the file, is passed on with the next call or at the end of this process.
    """
    with _EAR.lock:
        heard = _EAR.open()
        pass_on_late()
        _flush()
        try:
            saved = os.dup(_STDERR)
        except OSError:
            # A process may run without any standard error.
            saved = None
        try:
            os.dup2(heard, _STDERR)
            result = decode()
        finally:
            _flush()
            if saved is None:
                os.close(_STDERR)
            else:
                os.dup2(saved, _STDERR)
                os.close(saved)
            printed = _EAR.read()
            _pass_on(_COMPLAINT.sub(b"", printed))
    return result, [line.decode("utf-8", "replace").strip() for line in _COMPLAINT.findall(printed)]


def pass_on_late() -> None:
    """Print what came after standard error was put back."""
    _pass_on(_EAR.read())


def _pass_on(printed: bytes) -> None:
    # Whoever printed it would not have been told either where nothing can be printed.
    with suppress(OSError):
        # A line at a time: what is longer than a pipe takes at once can be torn by what others print.
        for line in printed.splitlines(keepends=True):
            while line:
                line = line[os.write(_STDERR, line) :]


def _flush() -> None:
    if sys.stderr is not None:
        sys.stderr.flush()


def _forget() -> None:
    """Have a forked process open a file of its own: what is in this one is its parent's to print."""
    global _EAR
    _EAR = _Ear()


atexit.register(pass_on_late)
os.register_at_fork(after_in_child=_forget)
