"""Logs of runs: what happened, one line each, kept beside the artifacts.

Each process of a run appends to a file of its own, so that no two writers share one, also on network file systems whose
appends are not atomic. Nothing is buffered: appended lines survive a kill.
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
"""Files that are known to this process to end with a whole line."""


class LocalLogs:
    """The methods of `LocalStore` on logs."""

    _layout: Layout

    def append_log(self, run_id: str, lines: bytes) -> None:
        folder = self._log_folder(run_id)
        path = f"{folder}/{process_space()}-{os.getpid()}.jsonl"
        try:
            try:
                _append(path, lines)
            except FileNotFoundError:
                self._layout.make_folder(folder)
                _append(path, lines)
        except OSError as error:
            where = self._layout.root
            raise StoreError(f"cannot write a run's log: {error.strerror}", where=where, got=run_id) from error

    def read_log(self, run_id: str) -> list[bytes]:
        """Return the lines of a run's log, without a last line that a kill cut short.

        A line that a full disk cut short is included if its process could write again afterwards.
        """
        lines: list[bytes] = []
        for path in sorted(self._log_folder(run_id).glob("*.jsonl")):
            try:
                content = path.read_bytes()
            except FileNotFoundError:
                continue
            except OSError as error:
                raise StoreError(f"cannot read a run's log: {error.strerror}", where=path) from error
            lines.extend(content[: content.rfind(b"\n") + 1].splitlines())
        return lines

    def logs(self) -> dict[str, float]:
        found = {}
        for folder in sorted(self._layout.logs.glob("*/")):
            times = []
            for path in folder.glob("*.jsonl"):
                # a collection may be deleting it
                with suppress(FileNotFoundError):
                    times.append(path.stat().st_mtime)
            if times:
                found[folder.name] = max(times)
        return found

    def remove_log(self, run_id: str) -> bool:
        folder = self._log_folder(run_id)
        if not folder.is_dir():
            return False
        shutil.rmtree(folder, ignore_errors=True)
        return True

    def _log_folder(self, run_id: str) -> Path:
        return self._layout.logs / check_run_id(run_id)


def _append(path: str, lines: bytes) -> None:
    """Write all lines, or raise; after an append that was cut short, the next one begins a new line."""
    with open(path, "a+b", buffering=0) as file:
        if path not in _whole and not _ends_whole(file):
            lines = b"\n" + lines
        _whole.discard(path)
        rest = memoryview(lines)
        # a nearly full disk writes a part, and raises only at the next write
        while rest:
            rest = rest[file.write(rest) :]
    _whole.add(path)


def _ends_whole(file: FileIO) -> bool:
    """Return whether a file is empty or ends with a whole line."""
    size = file.seek(0, os.SEEK_END)
    return size == 0 or os.pread(file.fileno(), 1, size - 1) == b"\n"
