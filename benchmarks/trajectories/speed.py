"""Time of `moseg eval` on sets of trajectories, in one process and with two workers.

``python benchmarks/trajectories/speed.py NAME=ROOT ... [--motions gt auto] [--json FILE]`` evaluates the sequences of
each data set into an empty store, first in one process, then with two workers, with one thread each. Seconds are those
that pass beyond the start of the command (``moseg --version``). Those of the processor, of all processes together,
depend less on what else runs on the machine. ``one by two`` is how many times faster two workers are. The modules are
compiled beforehand, as `pip` does when it installs them.

``--stand-ins 39310`` evaluates the official list of each set too, with so many trajectories in all: sequences that are
not on disk are replaced by others, with a part of their trajectories (`sequence_stand_ins.write_stand_ins`).
"""

import argparse
import compileall
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sequence_stand_ins import write_stand_ins

import moseg.schemas
import moseg.store
import moseg.tasks
import moseg.workflows

ROOMS = (moseg.schemas, moseg.store, moseg.tasks, moseg.workflows)
THREADS = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")


def run(*arguments: str) -> dict[str, float]:
    """Return the seconds of a `moseg` command: those that pass, and those of the processor."""
    before, started = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    command = [sys.executable, "-m", "moseg", *arguments]
    subprocess.run(command, check=True, env=os.environ | THREADS, stdout=subprocess.DEVNULL)
    seconds, after = time.perf_counter() - started, resource.getrusage(resource.RUSAGE_CHILDREN)
    return {"seconds": seconds, "cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime}


def evaluate(name: str, root: str, motions: str, num_workers: int, start: dict[str, float]) -> dict[str, float]:
    """Return the seconds of an evaluation beyond those of the start, and the number of its sequences."""
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder) / "report.json"
        choice = ("--variant", "fused", "--motions", motions, "--workers", str(num_workers))
        where = ("--root", root, "--store", str(Path(folder) / "store"), "--json", str(report))
        taken = run("eval", "--dataset", name, *choice, *where, "--quiet")
        (row,) = json.loads(report.read_text(encoding="utf-8"))["rows"]
    left = {unit: value - start[unit] for unit, value in taken.items()}
    return {**left, "sequences": len(row["sequences"]), "error": row["mean"]["error"]}


@contextmanager
def filled(name: str, root: str, num_tracks: int) -> Iterator[str]:
    """Yield a folder with links to the sequences of a set and stand-ins for those that are missing."""
    with tempfile.TemporaryDirectory() as folder:
        for entry in Path(root).resolve().iterdir():
            (Path(folder) / entry.name).symlink_to(entry)
        write_stand_ins(name, root, Path(folder), num_tracks)
        yield folder


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sets", nargs="+", metavar="NAME=ROOT")
    parser.add_argument("--motions", nargs="+", choices=("gt", "auto"), default=("gt", "auto"))
    parser.add_argument("--stand-ins", type=int, metavar="N", help="evaluate whole lists too, with N trajectories")
    parser.add_argument("--json", type=Path, help="write the figures here too")
    options = parser.parse_args()
    for room in ROOMS:
        compileall.compile_dir(*room.__path__, quiet=1)
    start = min((run("--version") for _ in range(3)), key=lambda taken: taken["seconds"])
    found: dict[str, dict[str, float]] = {}
    print(f"{'data set':28} {'sequences':>9} {'seconds':>8} {'CPU s':>7} {'two workers':>12} {'one by two':>11}")
    for name, root in (each.split("=", 1) for each in options.sets):
        for motions in options.motions:
            found[f"{name}-{motions}"] = compare(f"{name}-{motions}", name, root, motions, start)
        if options.stand_ins is not None:
            with filled(name, root, options.stand_ins) as folder:
                for motions in options.motions:
                    title = f"{name}-whole-{motions}"
                    found[title] = compare(title, name, folder, motions, start)
    if options.json is not None:
        options.json.write_text(json.dumps(found), encoding="utf-8")


def compare(title: str, name: str, root: str, motions: str, start: dict[str, float]) -> dict[str, float]:
    """Return and print the figures of a set in one process, and how many times faster two workers are."""
    one, two = (evaluate(name, root, motions, count, start) for count in (0, 2))
    if one["error"] != two["error"]:
        raise SystemExit(f"{title}: two workers have another error, {two['error']} instead of {one['error']}")
    found = {**one, "two": two["seconds"], "ratio": one["seconds"] / two["seconds"]}
    figures = f"{found['sequences']:9d} {found['seconds']:8.1f} {found['cpu']:7.1f} {found['two']:12.1f}"
    print(f"{title:28} {figures} {found['ratio']:11.2f}", flush=True)
    return found


if __name__ == "__main__":
    main()
