"""Overhead of a run beside its tasks: start, planning, store and scheduler.

Run ``python benchmarks/overhead.py [--dataset davis16 --root DIR] [--repeat N]``; the default, two small rendered
scenes, takes about two minutes, and its starts take longer than its tasks. Every run is a process of its own, from the
start of its interpreter to its exit; cold runs have a new store and one CPU thread per process. Printed are

- a cold run with one worker over the seconds inside task functions, from the manifests of its store (including
  decoding at ingest), and one with two workers;
- a warm run beyond the start of an interpreter that imports the same modules, and the import of the command line;
- the time of a cold run by place, from samples of the stacks of the client and of its worker (in a run of its own,
  because sampling costs a few per cent).

The kinds of run alternate, and ratios and differences are taken within a round; the medians of the rounds are printed.
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
from collections import defaultdict
from pathlib import Path
from statistics import median

from engine.commands import IMPORT_MODULES, LIST_MODULES, MOSEG, run_timed
from engine.stack_samples import FOLDER_VARIABLE

from moseg.store import LocalStore

IMPORT_APP = (sys.executable, "-c", "import moseg.workflows.cli.app")
BARE = (sys.executable, "-c", "pass")
SAMPLED = (
    sys.executable,
    "-c",
    "import stack_samples; stack_samples.start(); from moseg.workflows.cli import main; main()",
)
ENGINE = Path(__file__).parent / "engine"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dataset", default="synthetic")
    parser.add_argument("--root", default=None, help="the data set's folder")
    parser.add_argument("--sequences", default=None, help="only these, separated by commas (synthetic: two scenes)")
    parser.add_argument("--repeat", type=int, default=1, help="rounds of cold runs")
    parser.add_argument("--repeat-warm", type=int, default=5, help="rounds of warm runs")
    parser.add_argument("--scratch", type=Path, default=None, help="folder for the stores, until the end")
    parser.add_argument("options", nargs="*", help="options of `moseg eval`, after --")
    options = parser.parse_args()
    sequences = options.sequences or ("two-motions,crossing-movers" if options.dataset == "synthetic" else None)
    evaluation = ["eval", "--dataset", options.dataset, "--quiet", *options.options]
    evaluation += ["--root", options.root] if options.root else []
    evaluation += ["--sequences", sequences] if sequences else []
    scratch = Path(tempfile.mkdtemp(prefix="moseg-bench-", dir=options.scratch))
    try:
        run_timed(BARE)
        report_cold(evaluation, scratch, options.repeat)
        report_warm(evaluation, scratch, options.repeat_warm)
        report_places(evaluation, scratch)
    finally:
        shutil.rmtree(scratch)
    return 0


def report_cold(evaluation: list[str], scratch: Path, repeat: int) -> None:
    """Print one worker over its task functions, and two workers over one; leave a full store at ``scratch/warm``."""
    found: dict[str, list[float]] = defaultdict(list)
    for number in range(repeat):
        wall: dict[int, float] = {}
        session: dict[int, float] = {}
        for workers in (1, 2):
            store, report = scratch / f"cold-{number}-{workers}", scratch / "report.json"
            options = ["--store", str(store), "--json", str(report), "--workers", str(workers)]
            wall[workers] = run_timed([*MOSEG, *evaluation, *options])
            session[workers] = json.loads(report.read_text())["seconds"]
            inside = seconds_inside(store)
            found[f"wall {workers}"].append(wall[workers])
            found[f"inside {workers}"].append(inside)
            found[f"ratio {workers}"].append(wall[workers] / inside)
            found[f"session {workers}"].append(session[workers] / inside)
            if workers == 2 and number == repeat - 1:
                store.rename(scratch / "warm")
            else:
                shutil.rmtree(store)
        found["speed-up"].append(wall[1] / wall[2])
        found["session speed-up"].append(session[1] / session[2])
    of = {name: median(values) for name, values in found.items()}
    print(f"cold runs, medians of {repeat}")
    print("| workers | wall | inside task functions | wall / inside | session / inside |\n|---|---|---|---|---|")
    for workers in (1, 2):
        walls = f"{of[f'wall {workers}']:.1f} s | {of[f'inside {workers}']:.1f} s"
        print(f"| {workers} | {walls} | {of[f'ratio {workers}']:.3f} | {of[f'session {workers}']:.3f} |")
    print(f"one worker over its task functions: {of['ratio 1']:.3f} (target 1.15)")
    print(f"two workers against one: {of['speed-up']:.2f} times faster (target 1.8)")
    print(f"... of the session alone, without imports: {of['session speed-up']:.2f}", flush=True)


def report_warm(evaluation: list[str], scratch: Path, repeat: int) -> None:
    """Print a warm run beyond its imports, and the import of the command line."""
    warm = [*evaluation, "--store", str(scratch / "warm")]
    names = scratch / "modules"
    run_timed([sys.executable, "-c", LIST_MODULES, str(names), *warm])
    kinds = {
        "an interpreter that does nothing": [*BARE],
        "import of the command line (moseg.workflows.cli.app)": [*IMPORT_APP],
        "import of all that a warm eval loads": [sys.executable, "-c", IMPORT_MODULES, str(names)],
        "warm eval": [*MOSEG, *warm],
        "warm eval --workers 1": [*MOSEG, *warm, "--workers", "1"],
    }
    rounds = [{kind: run_timed(command) for kind, command in kinds.items()} for _ in range(repeat)]
    print(f"\nwarm, medians of {repeat}")
    for kind in kinds:
        print(f"{kind}: {median(each[kind] for each in rounds):.2f} s")
    bare, app, imports, whole, _ = kinds
    beyond = median(each[whole] - each[imports] for each in rounds)
    print(f"warm eval beyond interpreter and imports: {beyond:.2f} s (target 1)")
    beyond = median(each[app] - each[bare] for each in rounds)
    print(f"import of the command line beyond the interpreter: {beyond:.2f} s (target 1)", flush=True)


def report_places(evaluation: list[str], scratch: Path) -> None:
    """Print the time of a cold run's client and worker by place."""
    folder = scratch / "samples"
    folder.mkdir()
    environ = {
        FOLDER_VARIABLE: str(folder),
        "PYTHONPATH": os.pathsep.join(filter(None, [str(ENGINE), os.environ.get("PYTHONPATH")])),
        "DASK_DISTRIBUTED__WORKER__PRELOAD": "['stack_samples']",
    }
    wall = run_timed([*SAMPLED, *evaluation, "--store", str(scratch / "sampled"), "--workers", "1"], environ)
    inside = seconds_inside(scratch / "sampled")
    print(f"\nplaces of a cold run with one worker: {wall:.1f} s ({inside:.1f} s inside task functions), by samples")
    print("| process | in | s | of the wall |\n|---|---|---|---|")
    for path in sorted(folder.iterdir()):
        seconds = json.loads(path.read_text())
        seconds["before and after the samples"] = wall - sum(seconds.values())
        for place, spent in sorted(seconds.items(), key=lambda item: -item[1]):
            if spent >= 0.002 * wall:
                print(f"| {path.name.partition('-')[0]} | {place} | {spent:.2f} | {100 * spent / wall:.1f} % |")


def seconds_inside(root: Path) -> float:
    """Return the seconds inside task functions, over all artifacts of a store."""
    store = LocalStore(root, create=False)
    return sum(store.manifest(ref).seconds for ref in store.refs())


if __name__ == "__main__":
    sys.exit(main())
