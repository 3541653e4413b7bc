"""Damage to every kind of file of artifacts of every task: all of it is found, none is returned, all is repaired.

Run ``python benchmarks/faults/corruption.py [--rounds 1] [--seed 0] [--root DIR]``; some five minutes a round. A round
damages, for each kind of file (manifest, pack of the arrays) and each way (a flipped byte, a truncation, a deletion, an
emptied file, an extra byte), one artifact of every task that has such a file. The
laws are:

- `verify` names each damaged artifact and no other. What the store still returns of them equals what was stored.
- A run on the damaged store succeeds, and its labels and scores are those of the undamaged store.
- `verify --quarantine` removes the damaged artifacts that no task read; after their descendants are deleted, a run
  computes them again, and the store equals the undamaged one.
- The quarantine holds each damaged artifact with its damaged bytes, and nothing else.
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
from damages import DAMAGES, KINDS, Damaged, choose_artifacts, descendants, folder_of, inflict, read_quarantine
from ledger import Ledger
from processes import Ended, run_to_end
from workload import MOSEG, Workload, write_workload

from moseg.schemas.manifests import Manifest
from moseg.store import open_store

RESULTS = ("segmentation/", "score/")


class Intact(NamedTuple):
    """An undamaged store, the workload that filled it, and its contents."""

    workload: Workload
    folder: Path
    root: Path
    contents: Contents
    manifests: dict[str, Manifest]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=1, help="number of rounds, each with damage at other places")
    parser.add_argument("--seed", type=int, default=0, help="seed of the places")
    parser.add_argument("--root", type=Path, default=None, help="folder for temporary videos and stores")
    parser.add_argument("--frames", type=int, default=12, help="length of the video")
    parser.add_argument("--cases", nargs="+", default=None, help="only these, as 'pack:deletion'")
    options = parser.parse_args()
    cases = [f"{kind}:{damage}" for kind in KINDS for damage in DAMAGES]
    for case in options.cases or ():
        if case not in cases:
            parser.error(f"no case {case!r}; there are {', '.join(cases)}")
    rng = random.Random(options.seed)
    ledger = Ledger("file", "damage", "tasks", "found by verify", "met by a run", "made anew", "store at the end")
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="moseg-corruption-", dir=options.root))
        stack.callback(shutil.rmtree, folder)
        intact = prepare(folder, options.frames)
        for case in (options.cases or cases) * options.rounds:
            damage_once(intact, ledger, *case.split(":"), rng)
    return ledger.close()


def prepare(folder: Path, num_frames: int) -> Intact:
    """Evaluate the video into a store that is not changed afterwards."""
    workload = write_workload(folder / "data", num_frames, num_samples=200)
    ended = evaluate(workload, folder, folder / "intact")
    if ended.code:
        raise RuntimeError(ended.err)
    store = open_store(str(folder / "intact"), create=False)
    manifests = {ref: store.manifest(ref) for ref in store.refs()}
    return Intact(workload, folder, folder / "intact", read_contents(store.url), manifests)


def evaluate(workload: Workload, folder: Path, root: Path) -> Ended:
    """Run the evaluation in a process of its own, without a cache of arrays."""
    return run_to_end(workload.command("eval", str(root), folder / "report.json"), folder / "logs")


def damage_once(intact: Intact, ledger: Ledger, kind: str, damage: str, rng: random.Random) -> None:
    """Damage one artifact of every task, and check that it is found, kept out of results, and repaired."""
    case, root = f"{damage} of {kind}", intact.folder / "damaged"
    shutil.copytree(intact.root, root)
    store = open_store(str(root), create=False)
    # Nobody reads the pack of an artifact without arrays: a score is in its manifest.
    inflicted = {
        ref: inflict(folder_of(root, ref), kind, damage, rng)
        for ref in choose_artifacts(intact.manifests, rng)
        if kind != "pack" or intact.manifests[ref].arrays
    }
    damaged = {ref: damage for ref, damage in inflicted.items() if damage is not None}
    found = {result.ref for result in store.verify() if not result.is_intact}
    ledger.require(case, "verify names the damaged artifacts only", found == damaged.keys(), found ^ damaged.keys())
    served = read_contents(str(root)).results
    is_true = all(result == intact.contents.results[ref] for ref, result in served.items())
    ledger.require(case, "returned arrays are those stored", is_true)
    for ref in list(store.refs("score")):
        if ref not in damaged:
            store.remove(ref)

    first = evaluate(intact.workload, intact.folder, root)
    ledger.require(case, "a run succeeds without messages", (first.code, first.err) == (0, ""), first.err)
    is_same = results_of(read_contents(str(root))) == results_of(intact.contents)
    ledger.require(case, "labels and scores are those of the undamaged store", is_same)
    met = read_quarantine(root).keys()
    unread = damaged.keys() - met

    verify = [*MOSEG, "store", "verify", "--quarantine", "--store", str(root)]
    verified = run_to_end(verify, intact.folder / "logs")
    ledger.require(case, "verify reports damage that a run did not read", verified.code == bool(unread), verified)
    for ref in descendants(intact.manifests, unread):
        store.remove(ref)
    second = evaluate(intact.workload, intact.folder, root)
    ledger.require(case, "the next run succeeds without messages", (second.code, second.err) == (0, ""), second.err)
    after = read_contents(str(root))
    is_whole = after.results == intact.contents.results and not after.problems
    ledger.require(case, "the store equals the undamaged one", is_whole, after.problems)
    made = sum(after.written.get(ref) != intact.contents.written[ref] for ref in damaged)
    ledger.require(case, "damaged artifacts are computed again", made == len(damaged), made)
    require_quarantine(ledger, case, root, damaged)
    ledger.row(kind, damage, len(damaged), len(found), len(met), made, "identical" if is_whole else "OTHER")
    shutil.rmtree(root)


def results_of(contents: Contents) -> dict:
    """Return labels and scores."""
    return {ref: result for ref, result in contents.results.items() if ref.startswith(RESULTS)}


def require_quarantine(ledger: Ledger, case: str, root: Path, damaged: dict[str, Damaged]) -> None:
    """Check that the quarantine holds the damaged artifacts with their damaged bytes, and nothing else."""
    kept = read_quarantine(root)
    ledger.require(
        case, "what was damaged is in quarantine", kept.keys() == damaged.keys(), kept.keys() ^ damaged.keys()
    )
    for ref, file in damaged.items():
        path = kept[ref] / file.path if ref in kept else root / "nowhere"
        content = path.read_bytes() if path.exists() else None
        ledger.require(f"{case}, {ref}", "the quarantine holds the damaged bytes", content == file.content)


if __name__ == "__main__":
    sys.exit(main())
