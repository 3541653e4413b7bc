"""Damaged files of every kind that is read: each is read or refused in one line, within limits of memory and time.

Run ``python benchmarks/faults/fuzz_readers.py [--mutations 10000] [--seed 0] [--readers NAME …] [--json FILE] [--keep
DIR]``. Valid files of every kind are written and damaged: bits and bytes changed; ends, beginnings and spans lost,
doubled, inserted, blanked; sizes and counts replaced by critical integers; two files spliced; and the content of the
format changed below right checksums and lengths. The laws for each file are:

- The reader returns, or raises InputError (for a run's log in the store also StoreError) whose message is one line.
- Nothing is printed on standard error: no warning, and no message of a library in C.
- No signal ends the process.
- It takes no more seconds of CPU and no more memory than the limits.

A violation gives the number of the mutation: with the same seed it is always the same file, which ``--keep`` saves.
"""

import argparse
import gc
import json
import os
import re
import shutil
import sys
import tempfile
from collections import Counter
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

# Before any library that starts threads: a fork does not copy them.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[_name] = "1"

import cv2  # noqa: E402
from ledger import Ledger  # noqa: E402
from readers import list_readers  # noqa: E402
from trials import Limits, Reader, damaged_file, run_trials  # noqa: E402

MOST_KEPT = 5
"""Number of files of one cause that are saved."""
SHOWN = 160
"""Length of the prefix by which violations are grouped into causes."""


class Tally(NamedTuple):
    """Outcomes of the trials of one reader, counted."""

    reader: str
    mutations: int
    results: int
    refusals: int
    violations: int
    slowest_seconds: float
    most_megabytes: float
    kinds: dict[str, int]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--mutations", type=int, default=10_000, help="damaged files per reader")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--seed", type=int, default=0, help="seed of the damage")
    parser.add_argument("--readers", nargs="+", default=None, metavar="NAME", help="only these, by the start of a name")
    parser.add_argument("--seconds", type=float, default=2.0, help="limit of CPU time for one file, s")
    parser.add_argument("--megabytes", type=int, default=1024, help="limit of memory for one file, MiB")
    parser.add_argument("--root", type=Path, default=None, help="folder for temporary files")
    parser.add_argument("--json", type=Path, default=None, metavar="FILE", help="write the figures")
    parser.add_argument("--keep", type=Path, default=None, metavar="DIR", help="save the files of violations")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    limits = Limits(options.seconds, options.megabytes)
    indices = range(options.first, options.first + options.mutations)
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="moseg-fuzz-", dir=options.root))
        stack.callback(shutil.rmtree, folder)
        readers = list(list_readers(folder))
        chosen = [each for each in readers if not options.readers or each.name.startswith(tuple(options.readers))]
        if not chosen:
            parser.error(f"no such reader; there are {', '.join(each.name for each in readers)}")
        # All forks share the memory of now: collecting it would copy it into each.
        gc.freeze()
        ledger = Ledger("reader", "mutations", "results", "InputErrors", "violations", "slowest", "most memory")
        tallies = []
        for reader in chosen:
            tally = try_reader(ledger, reader, folder, options.seed, indices, limits, options.keep)
            tallies.append(tally._asdict())
            if options.json is not None:
                # After each reader: a long run may be cut off.
                report = {"seed": options.seed, "limits": limits._asdict(), "readers": tallies}
                options.json.write_text(json.dumps(report, indent=1) + "\n")
    return ledger.close()


def try_reader(
    ledger: Ledger, reader: Reader, folder: Path, seed: int, indices: range, limits: Limits, keep: Path | None
) -> Tally:
    """Run a reader on its damaged files; return a row of the table, and a line for each cause of violations."""
    outcomes: Counter[str] = Counter()
    causes: Counter[str] = Counter()
    slowest = most = 0.0
    for trial in run_trials(reader, folder, seed, indices, limits):
        outcomes[trial.outcome] += 1
        slowest, most = max(slowest, trial.seconds), max(most, trial.megabytes)
        if not trial.is_violation:
            continue
        cause = f"{trial.outcome}: {re.sub(r'[0-9]+', '#', trial.text)[:SHOWN]}"
        causes[cause] += 1
        if causes[cause] == 1:
            said = f"{trial.outcome} {' '.join(trial.text.split())}"
            ledger.require(f"{reader.name} {trial.index}", "a result or one line", False, said)
        if keep is not None and causes[cause] <= MOST_KEPT:
            keep.mkdir(parents=True, exist_ok=True)
            name = f"{reader.name.replace(' ', '-').replace(',', '')}-{trial.index}{Path(reader.file).suffix}"
            (keep / name).write_bytes(damaged_file(reader, seed, trial.index))
    results, refusals = outcomes.pop("result", 0), outcomes.pop("refusal", 0)
    violations = outcomes.total()
    ledger.require(reader.name, "every mutation was tried", results + refusals + violations == len(indices))
    ledger.require(reader.name, "nothing but results and refusals", not violations, f"{violations} of {dict(causes)}")
    figures = (round(slowest, 3), round(most, 1))
    ledger.row(reader.name, len(indices), results, refusals, violations, f"{figures[0]:.2f} s", f"{figures[1]:.0f} MiB")
    return Tally(reader.name, len(indices), results, refusals, violations, *figures, dict(outcomes))


if __name__ == "__main__":
    sys.exit(main())
