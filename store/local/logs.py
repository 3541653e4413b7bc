"""Logs of runs: what happened, a line each, kept beside the artifacts.

Each process of a run appends to a file of its own, so that no two writers share one, also on network file systems whose
appends are not atomic. Nothing is held back: what was appended is there after a kill.
"""

import os
import shutil
from contextlib import suppress
from io import FileIO
from pathlib import Path

from moseg.schemas.errors import StoreError
from moseg.store.local.layout import Layout
from moseg.store.names import check_run_id
from moseg.store.owners import process_space

_whole: set[str] = set()
"""Files of which this process knows that they end with a whole line."""


def append_log(layout: Layout, run_id: str, lines: bytes) -> None:
    """Add whole lines to a run's log; raises StoreError where the file system refuses."""
    folder = _folder(layout, run_id)
    path = f"{folder}/{process_space()}-{os.getpid()}.jsonl"
    try:
        try:
            _append(path, lines)
        except FileNotFoundError:
            layout.make_folder(folder)
            _append(path, lines)
    except OSError as error:
        raise StoreError(f"cannot write a run's log: {error.strerror}", where=layout.root, got=run_id) from error


def read_log(layout: Layout, run_id: str) -> list[bytes]:
    """The lines of a run's log, those of each process in order; a last line that a kill cut short is left out.

    A line that a full disk cut short is among them, where its process could write again.
    """
    lines: list[bytes] = []
    for path in sorted(_folder(layout, run_id).glob("*.jsonl")):
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            continue
        except OSError as error:
            raise StoreError(f"cannot read a run's log: {error.strerror}", where=path) from error
        lines.extend(content[: content.rfind(b"\n") + 1].splitlines())
    return lines


def logs(layout: Layout) -> dict[str, float]:
    """Runs that left a log, with the time at which it last grew, seconds since the epoch."""
    found = {}
    for folder in sorted(layout.logs.glob("*/")):
        times = []
        for path in folder.glob("*.jsonl"):
            # a collection may be deleting it
            with suppress(FileNotFoundError):
                times.append(path.stat().st_mtime)
        if times:
            found[folder.name] = max(times)
    return found


def remove_log(layout: Layout, run_id: str) -> bool:
    """Delete a run's log; False where there is none."""
    folder = _folder(layout, run_id)
    if not folder.is_dir():
        return False
    shutil.rmtree(folder, ignore_errors=True)
    return True


def _append(path: str, lines: bytes) -> None:
    """Write all lines, or raise; where an append was cut short, the next one begins a new line."""
    with open(path, "a+b", buffering=0) as file:
        if path not in _whole and not _ends_whole(file):
            lines = b"\n" + lines
        _whole.discard(path)
        rest = memoryview(lines)
        # a disk that is nearly full takes a part, and raises only at the next write
        while rest:
            rest = rest[file.write(rest) :]
    _whole.add(path)


def _ends_whole(file: FileIO) -> bool:
    """Whether a file is empty or ends with a whole line."""
    size = file.seek(0, os.SEEK_END)
    return size == 0 or os.pread(file.fileno(), 1, size - 1) == b"\n"


def _folder(layout: Layout, run_id: str) -> Path:
    return layout.logs / check_run_id(run_id)
