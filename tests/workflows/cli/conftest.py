"""The command line as a process of its own, with or without a terminal."""

import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Callable
from typing import NamedTuple

import pytest

MOSEG = (sys.executable, "-c", "from moseg.workflows.cli import main; main()")
_STYLE = re.compile(r"\x1b\[\??[0-9;]*[mhl]")
PATIENCE_SEC = 600.0


class Shown(NamedTuple):
    """How a command in a terminal ended and all that it wrote, and that without colours."""

    code: int
    raw: str

    @property
    def text(self) -> str:
        return _STYLE.sub("", self.raw)


@pytest.fixture
def in_process() -> Callable[..., subprocess.CompletedProcess]:
    """Runs a command and waits; keywords are those of `subprocess.run`, `env` is added to the environment's."""

    def call(*arguments, env=None, **options) -> subprocess.CompletedProcess:
        words = [*MOSEG, *map(str, arguments)]
        options = {"capture_output": True, "text": True, "check": False, "timeout": PATIENCE_SEC} | options
        return subprocess.run(words, env={**os.environ, **(env or {})}, **options)

    return call


def _take_terminal() -> None:
    """In the new process: its standard input is its terminal, and Ctrl-C there interrupts it.

    A shell that runs the tests in its background has them, and what they start, ignore Ctrl-C.
    """
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
    signal.signal(signal.SIGINT, signal.SIG_DFL)


@pytest.fixture
def in_terminal() -> Callable[..., Shown]:
    """Runs a command in a terminal of so many columns; `interrupt` says, by all that was written, when Ctrl-C comes.

    Another `program` than `moseg` gets the same arguments.
    """

    def call(*arguments, columns=80, env=None, interrupt=None, program=MOSEG[-1]) -> Shown:
        child, parent = pty.openpty()[::-1]
        fcntl.ioctl(parent, termios.TIOCSWINSZ, struct.pack("HHHH", 40, columns, 0, 0))
        environment = {name: value for name, value in os.environ.items() if name not in ("NO_COLOR", "COLUMNS")}
        process = subprocess.Popen(
            [*MOSEG[:-1], program, *map(str, arguments)],
            stdin=child,
            stdout=child,
            stderr=child,
            env={**environment, "TERM": "xterm-256color", **(env or {})},
            start_new_session=True,
            preexec_fn=_take_terminal,
        )
        os.close(child)
        written, deadline = b"", time.monotonic() + PATIENCE_SEC
        try:
            while time.monotonic() < deadline:
                if select.select([parent], [], [], 0.05)[0]:
                    try:
                        piece = os.read(parent, 65536)
                    except OSError:
                        break
                    if not piece:
                        break
                    written += piece
                if interrupt is not None and interrupt(written.decode(errors="replace")):
                    interrupt = None
                    os.write(parent, b"\x03")
            code = process.wait(timeout=PATIENCE_SEC)
        finally:
            process.kill()
            process.wait()
            os.close(parent)
        # Ctrl-C takes from a terminal what it has not drawn yet, parts of letters as well.
        return Shown(code, written.decode(errors="replace"))

    return call
