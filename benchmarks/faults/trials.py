"""Trials of a reader on damaged files, in forked processes with limits on memory and time."""

import mmap
import os
import random
import re
import resource
import signal
import struct
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from mutations import Mutate, mutate_bytes

from moseg.schemas.errors import InputError

TRIALS_A_PROCESS = 1000
"""Trials of one process: leaks of many must not add up to a violation."""
LONGEST_MESSAGE = 3000
DEADLINE_SEC = 60.0
"""Wall-clock limit of one trial, even on a busy machine: a trial that takes longer is blocked."""
_CONTROL = re.compile("[\x00-\x1f\x7f-\x9f\u2028\u2029]")
_RECORD = struct.Struct("<IBddI")
_SILENT = (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning)
"""Warnings that Python itself does not show to users."""


class Reader(NamedTuple):
    """A way into the program for files from outside.

    Attributes
    ----------
    name : str
    file : str
        Path of the damaged file in the trial's folder.
    seeds : tuple of bytes
        Valid files.
    read : callable
        Of the file's path: reads all of it.
    mutate : callable, optional
        Damage specific to the format; half of the trials get it if there is any.
    refusals : tuple of exception types
        How the reader may refuse a file.
    """

    name: str
    file: str
    seeds: tuple[bytes, ...]
    read: Callable[[Path], object]
    mutate: Mutate | None = None
    refusals: tuple[type[Exception], ...] = (InputError,)


class Limits(NamedTuple):
    """Seconds of CPU and MiB of memory that one file may take."""

    seconds: float
    megabytes: int


class Trial(NamedTuple):
    """Outcome of reading one damaged file.

    Attributes
    ----------
    outcome : str
        ``result``, ``refusal``, or the kind of violation: ``exception``, ``message``, ``printed``, ``time``,
        ``memory`` or the name of a signal.
    """

    index: int
    outcome: str
    seconds: float
    megabytes: float
    text: str

    @property
    def is_violation(self) -> bool:
        """Return whether it is neither a result nor a refusal in one line."""
        return self.outcome not in ("result", "refusal")


_OUTCOMES = ("result", "refusal", "exception", "message", "printed", "time", "memory")


def damaged_file(reader: Reader, seed: int, index: int) -> bytes:
    """Return the file of a trial; always the same for these numbers."""
    rng = random.Random(f"{seed} {reader.name} {index}")
    content = rng.choice(reader.seeds)
    if reader.mutate is not None and rng.random() < 0.5:
        content = reader.mutate(content, rng)
        if rng.random() < 0.8:
            return content
    return mutate_bytes(content, rng, reader.seeds)


def run_trials(reader: Reader, folder: Path, seed: int, indices: range, limits: Limits) -> Iterator[Trial]:
    """Read the damaged file of each number, in forks of this process, which has all modules loaded."""
    first = indices.start
    while first < indices.stop:
        batch = range(first, min(indices.stop, first + TRIALS_A_PROCESS))
        with _Fork(reader, folder, seed, batch, limits) as fork:
            for trial in fork.trials():
                yield trial
                first = trial.index + 1


class _Fork:
    """A process that reads files until it dies or none is left."""

    def __init__(self, reader: Reader, folder: Path, seed: int, indices: Sequence[int], limits: Limits):
        self._indices = indices
        # The numbers and the output outlive the process, also if it is killed.
        self._begun = mmap.mmap(-1, 4)
        self._begun[:] = struct.pack("<I", indices[0])
        self._printed = os.memfd_create("printed")
        self._results, results = os.pipe()
        sys.stdout.flush()
        sys.stderr.flush()
        self._pid = os.fork()
        if self._pid == 0:
            # No handler or clean-up of the parent may run here.
            try:
                os.close(self._results)
                self._read_all(reader, folder, seed, limits, results)
            except BaseException:
                traceback.print_exc()
                os._exit(1)
            os._exit(0)
        os.close(results)

    def __enter__(self) -> "_Fork":
        return self

    def __exit__(self, *exception) -> None:
        if self._pid:
            os.kill(self._pid, signal.SIGKILL)
            os.waitpid(self._pid, 0)
        os.close(self._results)
        os.close(self._printed)
        self._begun.close()

    def trials(self) -> Iterator[Trial]:
        """Iterate over the trials as they end; if the process died, the last one reports it."""
        last = self._indices[0] - 1
        with os.fdopen(os.dup(self._results), "rb") as results:
            while head := results.read(_RECORD.size):
                last, outcome, seconds, megabytes, length = _RECORD.unpack(head)
                yield Trial(last, _OUTCOMES[outcome], seconds, megabytes, results.read(length).decode())
        pid, self._pid = self._pid, 0
        code = os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
        (begun,) = struct.unpack("<I", self._begun[:])
        if code != 0:
            # An alarm means that it took too long; a death after the loop is attributed to the last file.
            name = "exit" if code > 0 else signal.Signals(-code).name
            outcome = "time" if name in ("SIGPROF", "SIGALRM") else name
            yield Trial(max(begun, last + 1), outcome, 0.0, 0.0, _read_from_start(self._printed)[-LONGEST_MESSAGE:])

    def _read_all(self, reader: Reader, folder: Path, seed: int, limits: Limits, results: int) -> None:
        for name in (1, 2):
            os.dup2(self._printed, name)
        for number in (signal.SIGINT, signal.SIGPROF, signal.SIGALRM):
            signal.signal(number, signal.SIG_DFL)
        warnings.resetwarnings()
        for category in _SILENT:
            warnings.simplefilter("ignore", category)
        warnings.simplefilter("always", append=True)
        space = _status_bytes(0) + 2 * limits.megabytes * 2**20
        resource.setrlimit(resource.RLIMIT_AS, (space, space))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        path = folder / reader.file
        for index in self._indices:
            self._begun[:] = struct.pack("<I", index)
            path.write_bytes(damaged_file(reader, seed, index))
            trial = self._read_once(reader, path, index, limits)
            text = trial.text.encode("utf-8", "backslashreplace")
            outcome = _OUTCOMES.index(trial.outcome)
            os.write(results, _RECORD.pack(index, outcome, trial.seconds, trial.megabytes, len(text)) + text)

    def _read_once(self, reader: Reader, path: Path, index: int, limits: Limits) -> Trial:
        taken = _forget_peak()
        signal.setitimer(signal.ITIMER_PROF, 5 * limits.seconds)
        signal.setitimer(signal.ITIMER_REAL, DEADLINE_SEC)
        started = time.process_time()
        outcome, text = _outcome(reader, path)
        seconds = time.process_time() - started
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        megabytes = max(0.0, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**10 - taken / 2**20)
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        if printed := _read_from_start(self._printed):
            os.ftruncate(self._printed, 0)
            os.lseek(self._printed, 0, os.SEEK_SET)
        if outcome in ("result", "refusal"):
            if printed:
                outcome, text = "printed", printed[:LONGEST_MESSAGE]
            elif seconds > limits.seconds:
                outcome, text = "time", f"{seconds:.1f} s; {text}"
            elif megabytes > limits.megabytes:
                outcome, text = "memory", f"{megabytes:.0f} MiB; {text}"
        return Trial(index, outcome, seconds, megabytes, text[:LONGEST_MESSAGE])


def _outcome(reader: Reader, path: Path) -> tuple[str, str]:
    try:
        reader.read(path)
    except reader.refusals as error:
        line = str(error)
        is_line = 0 < len(line) <= LONGEST_MESSAGE and not _CONTROL.search(line)
        return "refusal" if is_line else "message", repr(line)
    except BaseException as error:
        place = traceback.extract_tb(error.__traceback__)
        ours = [frame for frame in place if "site-packages" not in frame.filename] or place
        where = f"{Path(ours[-1].filename).name}:{ours[-1].lineno}"
        return "exception", f"{where}: {type(error).__name__}: {str(error)[:300]}"
    return "result", ""


def _forget_peak() -> int:
    """Reset the peak of memory and return the bytes that this process has now."""
    with open("/proc/self/clear_refs", "w") as file:
        file.write("5")
    return _status_bytes(1)


def _status_bytes(field: int) -> int:
    """Return the bytes of address space (0) or of memory (1) of this process."""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[field]) * os.sysconf("SC_PAGE_SIZE")


def _read_from_start(file: int) -> str:
    return os.pread(file, 2**20, 0).decode("utf-8", "replace")
