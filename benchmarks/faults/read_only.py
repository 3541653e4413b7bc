"""Stores that can be read and not written."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from contents import read_contents
from damages import folder_of
from mounts import memory_disk, remount
from places import Bench
from workload import read_counts

OTHER = ("--set", "fundamental.num_samples=201")
"""An option whose result is not in the store."""
NOBODY = ("setpriv", "--reuid=65534", "--regid=65534", "--clear-groups")
READ_ONLY, DENIED = "Read-only file system", "Permission denied"


def read_only(bench: Bench) -> None:
    """Use a read-only mount."""
    with memory_disk(bench.folder / "disk") as disk:
        store = disk / "store"
        shutil.copytree(bench.whole, store)
        before = read_contents(str(store))
        remount(disk, "ro")
        _ask_all(bench, "read-only", store, READ_ONLY, (), bench.workers)
        _ask_damaged(bench, disk, store)
        remount(disk, "rw")
        case = "read-only no more"
        ended = bench.evaluate(store)
        bench.require_success(case, ended)
        after = bench.require_whole(case, store)
        rewritten = [ref for ref in after.rewritten(before) if not ref.startswith("score/")]
        bench.ledger.require(case, "only the damaged artifact is written again", not rewritten, rewritten)
        bench.ledger.require(case, "all artifacts are stored", after.results == bench.contents.results)
        bench.require_success(case, bench.evaluate(store, *OTHER))
    (bench.folder / "disk").rmdir()


def forbidden(bench: Bench) -> None:
    """Use another user's folder; root does so as a user without rights.

    This user cannot start workers of a Python in root's home.
    """
    store = bench.folder / "theirs"
    shutil.copytree(bench.whole, store)
    before = NOBODY if os.geteuid() == 0 else ()
    folders = [store, *(path for path in store.rglob("*") if path.is_dir())]
    for folder in folders:
        folder.chmod(0o555)
    bench.folder.joinpath("report.json").unlink(missing_ok=True)
    bench.folder.chmod(0o777)
    try:
        _ask_all(bench, "forbidden", store, DENIED, before, bench.workers if _starts_python(before) else (0,))
        store.chmod(0o000)
        ended = bench.evaluate(store, before=before)
        bench.require_refusal("unreadable", ended, 2, DENIED, str(store))
        _row(bench, "unreadable", 0, ended)
    finally:
        bench.folder.chmod(0o755)
        for folder in folders:
            folder.chmod(0o755)
        shutil.rmtree(store)
        bench.folder.joinpath("report.json").unlink(missing_ok=True)


def _ask_all(
    bench: Bench, name: str, store: Path, words: str, before: tuple[str, ...], numbers: tuple[int, ...]
) -> None:
    """Check that stored results are returned and missing ones refused in one line, with these numbers of workers."""
    for workers in numbers:
        case = f"{name}, {workers} workers"
        warm = bench.evaluate(store, "--workers", str(workers), before=before)
        if bench.require_success(f"{case}, all stored", warm):
            bench.ledger.require(case, "nothing is computed", read_counts(warm.out)[0] == 0, warm.out)
        _row(bench, f"{name}, all stored", workers, warm)
        cold = bench.evaluate(store, *OTHER, "--workers", str(workers), before=before)
        bench.require_refusal(f"{case}, something new", cold, 1, words, str(store))
        _row(bench, f"{name}, something new", workers, cold)
    if bench.short:
        return
    for command in (("ls",), ("ls", "--runs"), ("verify",), ("du",), ("gc",)):
        bench.require_success(f"{name}, store {' '.join(command)}", bench.manage(store, *command, before=before))
    fresh = bench.evaluate(store.parent / "fresh" if words == READ_ONLY else store / "fresh", before=before)
    bench.require_refusal(f"{name}, a new store", fresh, 2, words, "fresh")
    _row(bench, f"{name}, a new store", 0, fresh)


def _ask_damaged(bench: Bench, disk: Path, store: Path) -> None:
    """Check that a damaged artifact, which cannot be quarantined there, is refused and not returned."""
    remount(disk, "rw")
    (ref,) = (ref for ref in bench.contents.results if ref.startswith("score/"))
    (folder_of(store, ref) / "manifest.json").write_bytes(b"")
    remount(disk, "ro")
    ended = bench.evaluate(store)
    bench.require_refusal("read-only, damaged", ended, 1, READ_ONLY, str(store))
    _row(bench, "read-only, damaged", 0, ended)


def _starts_python(before: tuple[str, ...]) -> bool:
    """Return whether a process under the command `before` can start another one."""
    start = "import subprocess, sys; subprocess.run([sys.executable, '-c', ''], check=True)"
    return subprocess.run([*before, sys.executable, "-c", start], capture_output=True, check=False).returncode == 0


def _row(bench: Bench, case: str, workers: int, ended) -> None:
    said = " ".join(ended.err.split()).replace(str(bench.folder), "…")
    bench.ledger.row(case, workers, ended.code, said, "-", "-")
