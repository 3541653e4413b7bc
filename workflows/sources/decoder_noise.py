"""What image decoders in C print on standard error: their only word on damage that they decode all the same."""

import os
import re
import sys
import tempfile
from collections.abc import Callable
from threading import Lock
from typing import BinaryIO, TypeVar

Result = TypeVar("Result")

_STDERR = 2
_COMPLAINT = re.compile(
    rb"(?:libpng error|libpng warning|Corrupt JPEG data|Inconsistent progression sequence|Invalid SOS parameters"
    rb"|Premature end of JPEG file|Unknown Adobe color transform|Warning: unknown JFIF revision)[^\n]*\n?"
)
"""What libpng or libjpeg say, to the end of the line. The line may begin with what another thread left unfinished."""
_LOCK = Lock()


def listen_to(decode: Callable[[], Result]) -> tuple[Result, list[str]]:
    """What `decode` returns, and the lines that it made libpng or libjpeg print.

    These are kept from standard error. What another thread prints meanwhile is passed on a little later, and what it
    decodes by other means is taken for `decode`'s. A process that another thread starts meanwhile keeps a standard
    error that leads nowhere.
    """
    with _LOCK, _open_ear() as heard:
        _flush()
        try:
            saved = os.dup(_STDERR)
        except OSError:
            # A process may run without any standard error.
            saved = None
        os.dup2(heard.fileno(), _STDERR)
        try:
            result = decode()
        finally:
            _flush()
            if saved is None:
                os.close(_STDERR)
            else:
                os.dup2(saved, _STDERR)
                os.close(saved)
        heard.seek(0)
        printed = heard.read()
    others = _COMPLAINT.sub(b"", printed)
    if others and saved is not None:
        os.write(_STDERR, others)
    return result, [line.decode("utf-8", "replace").strip() for line in _COMPLAINT.findall(printed)]


def _open_ear() -> BinaryIO:
    """A file to print into: in memory where there is such a thing, for a machine may have no temporary folder."""
    if hasattr(os, "memfd_create"):
        return os.fdopen(os.memfd_create("decoder"), "w+b")
    return tempfile.TemporaryFile()


def _flush() -> None:
    if sys.stderr is not None:
        sys.stderr.flush()
