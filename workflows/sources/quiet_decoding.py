"""OpenCV's decoding of images, with what image decoders in C print on standard error captured.

These lines are the only report of damage that the decoders decode nevertheless.
"""

import atexit
import fcntl
import mmap
import os
import re
import sys
import tempfile
import time
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from threading import Lock
from typing import TypeVar

import cv2
import numpy as np

Result = TypeVar("Result")

_STDERR = 2
_READ_BYTES = 1 << 16
_MAX_WAITS, _WAIT_SEC = 20, 1e-3  # for the rest of a line that another thread is writing
_COMPLAINT = re.compile(
    rb"(?:libpng error|libpng warning|Corrupt JPEG data|Inconsistent progression sequence|Invalid SOS parameters"
    rb"|Premature end of JPEG file|Unknown Adobe color transform|Warning: unknown JFIF revision)[^\n]*\n?"
)
"""A line of libpng or libjpeg, to its end. It may follow the unfinished line of another thread."""


def decode_quietly(content: bytes, flags: int) -> tuple[np.ndarray | None, list[str]]:
    """Decode an image with OpenCV.

    Parameters
    ----------
    content : bytes
        Of the whole file.
    flags : int
        OpenCV's ``IMREAD_*``.

    Returns
    -------
    image : (y, x) or (y, x, channel), or None
        Colours in OpenCV's order; None if OpenCV cannot decode the bytes.
    complaints : list of str
        Lines of libpng and libjpeg.
    """
    return capture_stderr(partial(_decode, content, flags))


def _decode(content: bytes, flags: int) -> np.ndarray | None:
    level = cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    try:
        return cv2.imdecode(np.frombuffer(content, np.uint8), flags)
    except cv2.error:
        return None
    finally:
        cv2.utils.logging.setLogLevel(level)


class _Capture:
    """A file that replaces standard error, and how much of it was read.

    All decoding of a process uses the same file: a write that another thread began before standard error was restored
    may end later, and is then found in the file.
    """

    def __init__(self):
        self.lock = Lock()
        self._file: int | None = None
        self._num_read = 0

    def open(self) -> int:
        """Return the file's descriptor; the file is in memory if possible, as there may be no temporary folder."""
        if self._file is None:
            if hasattr(os, "memfd_create"):
                self._file = os.memfd_create("decoder", os.MFD_CLOEXEC)
            else:
                with tempfile.TemporaryFile() as file:
                    self._file = os.dup(file.fileno())
            # Threads that print at the same time must not overwrite each other.
            fcntl.fcntl(self._file, fcntl.F_SETFL, fcntl.fcntl(self._file, fcntl.F_GETFL) | os.O_APPEND)
        return self._file

    def read(self) -> bytes:
        """Return what was printed since the last call."""
        if self._file is None:
            return b""
        printed = self._read_available()
        for _ in range(_MAX_WAITS):
            # The bytes of one write appear page by page: the rest of this line may follow.
            if not printed or printed.endswith(b"\n") or self._num_read % mmap.PAGESIZE:
                break
            time.sleep(_WAIT_SEC)
            printed += self._read_available()
        return printed

    def _read_available(self) -> bytes:
        pieces = []
        # By position: read would move the offset at which other threads write.
        while piece := os.pread(self._file, _READ_BYTES, self._num_read):
            pieces.append(piece)
            self._num_read += len(piece)
        return b"".join(pieces)


_CAPTURE = _Capture()


def capture_stderr(decode: Callable[[], Result]) -> tuple[Result, list[str]]:
    """Return the result of `decode`, and the lines that libpng or libjpeg printed meanwhile.

    Standard error does not get these lines, even if `decode` raises. What other threads print meanwhile is passed on
    a little later; lines of their decoders count as `decode`'s. What a process prints that another thread starts
    meanwhile, which inherits the file, is passed on with the next call or at the end of this process.
    """
    with _CAPTURE.lock:
        file = _CAPTURE.open()
        pass_on_late()
        _flush()
        try:
            saved = os.dup(_STDERR)
        except OSError:
            # A process may have no standard error.
            saved = None
        try:
            os.dup2(file, _STDERR)
            result = decode()
        finally:
            _flush()
            if saved is None:
                os.close(_STDERR)
            else:
                os.dup2(saved, _STDERR)
                os.close(saved)
            printed = _CAPTURE.read()
            _pass_on(_COMPLAINT.sub(b"", printed))
    return result, [line.decode("utf-8", "replace").strip() for line in _COMPLAINT.findall(printed)]


def pass_on_late() -> None:
    """Print what was captured after standard error was restored."""
    _pass_on(_CAPTURE.read())


def _pass_on(printed: bytes) -> None:
    # If nothing can be printed, the original print would have failed too.
    with suppress(OSError):
        # One line at a time: output of other threads can interrupt a write that is longer than a pipe's buffer.
        for line in printed.splitlines(keepends=True):
            while line:
                line = line[os.write(_STDERR, line) :]


def _flush() -> None:
    if sys.stderr is not None:
        sys.stderr.flush()


def _forget() -> None:
    """Make a forked process open its own file: what is in this one is printed by its parent."""
    global _CAPTURE
    _CAPTURE = _Capture()


atexit.register(pass_on_late)
os.register_at_fork(after_in_child=_forget)
