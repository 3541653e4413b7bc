"""Runs killed with SIGKILL at random times, each resumed by the same command.

Run ``python benchmarks/faults/crash.py [--kills 50] [--seed 0] [--root DIR] [--object-store]``; some twelve minutes for
50 kills. Victims are the client, a worker, both, or the whole process group, of `moseg eval` and `moseg segment`, with
two worker processes and within one; six in ten kills hit a step of writing into the store. The laws are:

- All processes that the run started end by themselves, and then `verify` finds no damage: visible artifacts are
  complete. The visible masks are those of an undisturbed run.
- If only a worker dies, the run itself finishes.
- The resumed run computes as many artifacts as were missing and writes none again.
- At the end every artifact's decoded bytes and results, and the masks, are those of the undisturbed run.
"""

import argparse
import random
import shutil
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from contents import Contents, read_contents
from kills import CELLS, Cell, Experiment, command_of, kill_in_time
from ledger import Ledger
from object_store import serve_objects
from processes import run_to_end
from workload import read_counts, read_files, write_workload

ORPHAN_PATIENCE_SEC = 120.0
"""A worker that outlives its client by more wastes memory and cores."""


class Whole(NamedTuple):
    """Results of an undisturbed run: the store's contents and the masks."""

    contents: Contents
    masks: dict[str, bytes]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=50, help="runs to kill")
    parser.add_argument("--seed", type=int, default=0, help="seed of the moments")
    parser.add_argument("--root", type=Path, default=None, help="folder for temporary videos and stores")
    parser.add_argument("--object-store", action="store_true", help="keep artifacts in an S3 server (moto)")
    parser.add_argument("--cells", nargs="+", choices=[str(cell) for cell in CELLS], default=None, help="only these")
    parser.add_argument("--only-steps", action="store_true", help="kill on steps of writing into the store only")
    parser.add_argument("--frames", type=int, default=16, help="length of the video")
    options = parser.parse_args()
    cells = [cell for cell in CELLS if options.cells is None or str(cell) in options.cells]
    ledger = Ledger("run", "command", "workers", "victim", "killed at", "stored", "all gone after", "computed")
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="moseg-crash-", dir=options.root))
        stack.callback(shutil.rmtree, folder)
        objects = stack.enter_context(serve_objects()) if options.object_store else None
        # Kills at random times need runs that take long enough.
        num_samples = 50 if options.only_steps else 2000
        workload = write_workload(folder / "data", options.frames, num_samples)
        experiment = Experiment(workload, folder, objects, random.Random(options.seed), options.only_steps)
        wholes = {name: run_undisturbed(experiment, name) for name in dict.fromkeys(cell.command for cell in cells)}
        for number in range(options.kills):
            cell = cells[number % len(cells)]
            crash_once(experiment, ledger, number, cell, wholes[cell.command])
    return ledger.close()


def run_undisturbed(experiment: Experiment, command: str) -> Whole:
    """Run in one process and return its results."""
    places = experiment.places(f"whole-{command}", command)
    ended = run_to_end(experiment.workload.command(command, places.store, places.out), places.logs)
    contents = read_contents(places.store)
    if ended.code or contents.problems or contents.num_computed() != read_counts(ended.out)[0]:
        raise RuntimeError(f"the undisturbed run failed: {ended}, {contents.problems}")
    return Whole(contents, read_files(places.out, ["*.png"]))


def crash_once(experiment: Experiment, ledger: Ledger, number: int, cell: Cell, whole: Whole) -> None:
    """Kill one run, resume it, and check each law."""
    case = f"run {number}, {cell}"
    places, moment, run = kill_in_time(experiment, number, cell, len(whole.contents.results))
    ended = run.wait()
    if cell.victim == "worker":
        ledger.require(case, "the run finishes", ended.code == 0, f"{ended.code}: {ended.err}")
    gone = run.outlive(ORPHAN_PATIENCE_SEC)
    ledger.require(case, f"all processes end within {ORPHAN_PATIENCE_SEC:.0f} s", gone is not None)

    before = read_contents(places.store)
    ledger.require(case, "no incomplete artifact is visible", not before.problems, before.problems)
    expected = {ref: whole.contents.results.get(ref) for ref in before.results}
    ledger.require(case, "stored artifacts are those of an undisturbed run", before.results == expected)
    visible = read_files(places.out, ["*.png"])
    ledger.require(case, "visible masks are complete", visible == {path: whole.masks.get(path) for path in visible})

    resumed = run_to_end(command_of(experiment, cell, places), places.logs)
    ledger.require(case, "the same command continues", resumed.code == 0, f"{resumed.code}: {resumed.err}")
    if resumed.code:
        return
    after = read_contents(places.store)
    computed, missing = read_counts(resumed.out)[0], after.num_computed(before)
    ledger.require(case, "it computes the missing artifacts", computed == missing, f"{computed} of {missing}")
    ledger.require(case, "nothing is written again", not after.rewritten(before), after.rewritten(before))
    ledger.require(case, "nothing is damaged at the end", not after.problems, after.problems)
    ledger.require(case, "all artifacts are identical", after.results == whole.contents.results)
    ledger.require(case, "all masks are identical", read_files(places.out, ["*.png"]) == whole.masks)
    stored = f"{len(before.results)} of {len(after.results)}"
    ledger.row(number, *cell, moment, stored, "-" if gone is None else f"{gone:.2f} s", computed)


if __name__ == "__main__":
    sys.exit(main())
