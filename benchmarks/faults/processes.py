"""Runs of `moseg` as separate processes: started, killed, and awaited until all their processes have ended."""

import os
import signal
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import psutil

DEADLINE_SEC = 300.0
"""No run here takes longer, even on a busy machine: a run that does hangs."""
PAUSE_SEC = 0.01


class Ended(NamedTuple):
    """Exit code and output of a run."""

    code: int
    out: str
    err: str

    def is_one_line(self, *words: str) -> bool:
        """Return whether it printed one line of error, of this program and with these words in it, and no traceback."""
        lines = self.err.strip().splitlines()
        return len(lines) == 1 and lines[0].startswith("moseg: ") and all(word in lines[0] for word in words)


class Run:
    """A command that runs in a process group of its own; its output goes to files, so that no full pipe blocks it."""

    def __init__(self, command: Sequence[str], folder: Path, env: Mapping[str, str] | None = None):
        folder.mkdir(parents=True, exist_ok=True)
        self._out, self._err = folder / "stdout", folder / "stderr"
        with self._out.open("wb") as out, self._err.open("wb") as err:
            self._process = subprocess.Popen(
                command, stdout=out, stderr=err, start_new_session=True, env=None if env is None else dict(env)
            )
        self.pid = self._process.pid

    def is_over(self) -> bool:
        """Return whether the client has ended."""
        return self._process.poll() is not None

    def workers(self) -> list[int]:
        """Return the process numbers of its live workers, which are started by spawn."""
        return [pid for pid, line in self._group().items() if "spawn_main" in line and pid != self.pid]

    def kill(self, victim: str, worker: int | None = None) -> None:
        """SIGKILL the ``client``, this ``worker``, ``both`` at once, or the whole ``group``."""
        if victim == "group":
            os.killpg(self.pid, signal.SIGKILL)
            return
        if victim in ("worker", "both"):
            _kill(worker)
        if victim in ("client", "both"):
            _kill(self.pid)

    def wait(self) -> Ended:
        """Wait for the client; if it hangs, kill everything and raise subprocess.TimeoutExpired."""
        try:
            code = self._process.wait(DEADLINE_SEC)
        except subprocess.TimeoutExpired:
            os.killpg(self.pid, signal.SIGKILL)
            self._process.wait()
            raise
        return Ended(code, self._out.read_text(errors="replace"), self._err.read_text(errors="replace"))

    def outlive(self, patience_sec: float) -> float | None:
        """Return the seconds until all processes of the run have ended; None if some had to be killed."""
        started = time.monotonic()
        while self._group():
            if time.monotonic() - started > patience_sec:
                os.killpg(self.pid, signal.SIGKILL)
                return None
            time.sleep(PAUSE_SEC)
        return time.monotonic() - started

    def _group(self) -> dict[int, str]:
        """Return the command lines of the live processes of its group, by number."""
        found = {}
        for process in psutil.process_iter():
            try:
                if os.getpgid(process.pid) == self.pid and process.status() != psutil.STATUS_ZOMBIE:
                    found[process.pid] = " ".join(process.cmdline())
            except (psutil.Error, ProcessLookupError):
                continue
        return found


def run_to_end(command: Sequence[str], folder: Path, env: Mapping[str, str] | None = None) -> Ended:
    """Run a command and wait for it."""
    return Run(command, folder, env).wait()


def wait_until(is_true: Callable[[], bool]) -> None:
    """Wait until a condition holds; raise TimeoutError if it takes too long."""
    deadline = time.monotonic() + DEADLINE_SEC
    while not is_true():
        if time.monotonic() > deadline:
            raise TimeoutError(f"waited {DEADLINE_SEC:.0f} s in vain")
        time.sleep(PAUSE_SEC)


def _kill(pid: int) -> None:
    try:
        os.kill(pid, signal.SIGKILL)
    except ProcessLookupError:
        # It ended by itself at this moment.
        return
