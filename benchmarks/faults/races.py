"""Many processes that run the same evaluation on one empty store at once.

Run ``python benchmarks/faults/races.py [--processes 8] [--rounds 5] [--root DIR]``; some minutes. The laws are: every
process succeeds and prints no warning, all report the same scores, each artifact was computed by one of them, staging
and quarantine are empty, `verify` finds no damage, and the store equals that of one process alone.
"""

import argparse
import json
import shutil
import sys
import tempfile
from contextlib import ExitStack
from pathlib import Path

from contents import Contents, read_contents
from ledger import Ledger
from processes import Run
from workload import Workload, read_counts, read_files, write_workload


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--processes", type=int, default=8, help="number of simultaneous processes")
    parser.add_argument("--rounds", type=int, default=5, help="races, each on an empty store")
    parser.add_argument("--root", type=Path, default=None, help="folder for temporary videos and stores")
    parser.add_argument("--frames", type=int, default=16, help="length of the video")
    options = parser.parse_args()
    ledger = Ledger("round", "ended well", "artifacts", "computed by each", "sum", "lost races")
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="moseg-races-", dir=options.root))
        stack.callback(shutil.rmtree, folder)
        workload = write_workload(folder / "data", options.frames, num_samples=200)
        alone = read_contents_of_race(ledger, "alone", folder, workload, 1)[0]
        for number in range(options.rounds):
            case = f"round {number}"
            contents, rows = read_contents_of_race(ledger, case, folder, workload, options.processes)
            ledger.require(case, "all report the same scores", len(set(rows)) == 1, set(rows))
            ledger.require(case, "all artifacts are those of a single process", contents.results == alone.results)
    return ledger.close()


def read_contents_of_race(
    ledger: Ledger, case: str, folder: Path, workload: Workload, num_processes: int
) -> tuple[Contents, list[str]]:
    """Race on an empty store; return its contents, and the scores that each process reported."""
    place = folder / case.replace(" ", "")
    store = place / "store"
    reports = [place / f"{number}.json" for number in range(num_processes)]
    runs = [Run(workload.command("eval", str(store), path), place / f"{path.stem}-logs") for path in reports]
    ended = [run.wait() for run in runs]
    faults = [each.err for each in ended if each.code]
    ledger.require(case, "every process succeeds", not faults, faults)
    contents = read_contents(str(store))
    computed = [read_counts(each.out)[0] for each in ended if not each.code]
    reused = [read_counts(each.out)[1] for each in ended if not each.code]
    ledger.require(case, "nothing is damaged", not contents.problems, contents.problems)
    for name in ("staging", "quarantine"):
        left = list(read_files(store / name))
        ledger.require(case, f"{name} is empty", not left, left)
    # Each process that decoded a file records its leaves, all with the same content.
    num_ingests = sum(ref.startswith("ingest/") for ref in contents.results)
    once, extra = contents.num_computed(), sum(computed) - contents.num_computed()
    is_once = 0 <= extra <= num_ingests * (num_processes - 1) and len(computed) == num_processes
    ledger.require(case, "each artifact is computed by one process", is_once or bool(faults), computed)
    well = f"{len(computed)} of {num_processes}"
    ledger.row(case, well, len(contents.results), computed, f"{sum(computed)} for {once}", sum(reused))
    rows = [json.dumps(json.loads(path.read_text())["rows"]) for path in reports if path.exists()]
    shutil.rmtree(place)
    return contents, rows


if __name__ == "__main__":
    sys.exit(main())
