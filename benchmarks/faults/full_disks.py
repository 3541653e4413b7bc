"""Runs whose disk fills up."""

import shutil
from pathlib import Path

from mounts import ROOMY, memory_disk, remount
from places import Bench
from processes import run_to_end
from workload import read_files

NO_SPACE, TOO_LARGE = "No space left on device", "File too large"
PAGE = 4096
TOO_SMALL, TOO_SMALL_CODE = "too little space on the disk", 2
"""What a run says, and its exit code, where the disk has less than it is estimated to take."""
SHARES = (0.05, 0.5, 0.95)
"""Sizes of the disk, as a share of what an undisturbed run takes."""
FILE_LIMIT_KIB = 40
"""Between the sizes of small artifacts, which fit, and of flows, which do not."""


def full(bench: Bench) -> None:
    """Run on a disk of fewer bytes than the run needs."""
    needed = sum(-(-len(content) // PAGE) * PAGE for content in read_files(bench.whole).values())
    for share in (SHARES[0], SHARES[-1]) if bench.short else SHARES:
        for workers in bench.workers:
            _fill(bench, f"full at {share:.0%}", f"size={int(needed * share)}", workers)


def inodes(bench: Bench) -> None:
    """Run on a disk of fewer files than the run needs."""
    needed = sum(1 for _ in bench.whole.rglob("*"))
    for share in SHARES[1:2] if bench.short else SHARES:
        for workers in bench.workers:
            _fill(bench, f"no inodes at {share:.0%}", f"size=256m,nr_inodes={int(needed * share)}", workers)


def file_size(bench: Bench) -> None:
    """Run under a limit on the size of files instead of on a small disk."""
    store = bench.folder / "limited"
    for workers in bench.workers:
        case = f"file size, {workers} workers"
        limit = ("prlimit", f"--fsize={FILE_LIMIT_KIB * 1024}")
        ended = bench.evaluate(store, "--workers", str(workers), before=limit)
        bench.require_refusal(case, ended, 1, TOO_LARGE, str(store))
        before = bench.require_whole(case, store)
        resumed = bench.evaluate(store, "--workers", str(workers))
        computed = bench.require_rest(case, store, before, resumed)
        _row(bench, "file size", workers, ended, len(before.results), computed)
        shutil.rmtree(store)


def output(bench: Bench) -> None:
    """Write masks, overlay and summary, and the report, to a full disk."""
    for name, size in (("segment", "size=16k"), ("segment", "size=60k"), ("eval", "size=4k")):
        with memory_disk(bench.folder / "disk", size) as disk:
            (disk / "ballast").write_bytes(bytes(PAGE))
            out = disk / ("out" if name == "segment" else "report.json")
            ended = run_to_end(bench.workload.command(name, str(bench.whole), out), bench.folder / "logs")
            case = f"output of {name}, {size}"
            bench.require_refusal(case, ended, 1, NO_SPACE, str(disk))
            parts = [path for path in read_files(disk) if path.endswith(".part")]
            bench.ledger.require(case, "no partial files are left", not parts, parts)
        (bench.folder / "disk").rmdir()
        _row(bench, case, 0, ended, "-", "-")


def _fill(bench: Bench, name: str, size: str, workers: int) -> None:
    """Run until the disk is full, or to the refusal of a disk that is too small for the estimate; then with room."""
    case = f"{name}, {workers} workers"
    with memory_disk(bench.folder / "disk", size) as disk:
        store = disk / "store"
        ended = bench.evaluate(store, "--workers", str(workers))
        is_too_small = ended.code == TOO_SMALL_CODE
        code, said = (TOO_SMALL_CODE, TOO_SMALL) if is_too_small else (1, NO_SPACE)
        bench.require_refusal(case, ended, code, said, str(store))
        before = bench.require_whole(case, store)
        if is_too_small:
            bench.ledger.require(case, "nothing is computed on it", not before.results, len(before.results))
        _require_no_litter(bench, case, store, workers)
        remount(disk, ROOMY)
        computed = bench.require_rest(case, store, before, bench.evaluate(store, "--workers", str(workers)))
        _row(bench, name, workers, ended, len(before.results), computed)
    (bench.folder / "disk").rmdir()


def _require_no_litter(bench: Bench, case: str, store: Path, workers: int) -> None:
    """Check that the files of a failed put are deleted: they would keep the disk full.

    Workers may be ended during a put.
    """
    left = list(read_files(store / "staging"))
    if workers == 0:
        bench.ledger.require(case, "a failed put leaves nothing in staging", not left, left)


def _row(bench: Bench, case: str, workers: int, ended, stored: object, computed: object) -> None:
    said = " ".join(ended.err.split()).replace(str(bench.folder), "…")
    bench.ledger.row(case, workers, ended.code, said, stored, computed)
