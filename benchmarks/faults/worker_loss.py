"""Runs that lose workers.

Run ``python benchmarks/faults/worker_loss.py [--rounds 3] [--seed 0] [--root DIR]``; some minutes. Workers are killed
with SIGKILL once a random number of artifacts is stored: one or both of the run's own (``--workers 2``); one of an
existing cluster that is not restarted; one that its nanny restarts; both, and another joins then. The run must finish
with the artifacts of an undisturbed one. If a task kills every worker that runs it, the run must end with one line and
exit code 1 instead of continuing for ever, and the same command must succeed once the task kills no more.
"""

import argparse
import random
import shutil
import sys
import tempfile
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import NamedTuple

from contents import Contents, count_artifacts, read_contents
from dask_cluster import serve_cluster
from deaths import die_at_task
from ledger import Ledger
from processes import Ended, Run, run_to_end, wait_until
from workload import Workload, read_counts, write_workload

DEADLY = "fundamental"
"""Task on which some tasks depend and others do not."""


class Bench(NamedTuple):
    """The workload, a scratch folder, the results of an undisturbed run, and the random generator."""

    workload: Workload
    folder: Path
    whole: Contents
    rng: random.Random

    def start(self, store: Path, *options: str, env: Mapping[str, str] | None = None) -> Run:
        """Start the evaluation."""
        command = self.workload.command("eval", str(store), self.folder / "report.json", *options)
        return Run(command, self.folder / "logs", env)

    def wait_for_some(self, run: Run, store: Path) -> int:
        """Wait until a random number of artifacts is stored; return that number."""
        num_stored = self.rng.randint(1, len(self.whole.results) - 20)
        wait_until(lambda: run.is_over() or count_artifacts(str(store)) >= num_stored)
        return num_stored


def own_worker(bench: Bench, store: Path) -> tuple[Ended, int]:
    """Kill one of the run's own two workers."""
    run = bench.start(store, "--workers", "2")
    num_stored = bench.wait_for_some(run, store)
    for worker in run.workers()[:1]:
        run.kill("worker", worker)
    return run.wait(), num_stored


def own_workers(bench: Bench, store: Path) -> tuple[Ended, int]:
    """Kill both of the run's own workers."""
    run = bench.start(store, "--workers", "2")
    num_stored = bench.wait_for_some(run, store)
    for worker in run.workers():
        run.kill("worker", worker)
    return run.wait(), num_stored


def lost_worker(bench: Bench, store: Path) -> tuple[Ended, int]:
    """Kill one of a cluster's two workers, which is not restarted."""
    return _on_cluster(bench, store, False, lambda cluster, workers: workers[0].kill("group"))


def restarted_worker(bench: Bench, store: Path) -> tuple[Ended, int]:
    """Kill one of a cluster's two workers; its nanny restarts it."""

    def kill(cluster, workers):
        for worker in workers[0].workers():
            workers[0].kill("worker", worker)

    return _on_cluster(bench, store, True, kill)


def replaced_workers(bench: Bench, store: Path) -> tuple[Ended, int]:
    """Kill both of a cluster's workers; then another joins."""

    def kill(cluster, workers):
        for worker in workers:
            worker.kill("group")
        cluster.start_worker(has_nanny=False)

    return _on_cluster(bench, store, False, kill)


def _on_cluster(bench: Bench, store: Path, has_nanny: bool, kill: Callable) -> tuple[Ended, int]:
    with serve_cluster(store.parent / "cluster") as cluster:
        workers = [cluster.start_worker(has_nanny) for _ in range(2)]
        run = bench.start(store, "--scheduler", cluster.address)
        num_stored = bench.wait_for_some(run, store)
        kill(cluster, workers)
        return run.wait(), num_stored


SURVIVED: dict[str, Callable[[Bench, Path], tuple[Ended, int]]] = {
    "own-worker": own_worker,
    "own-workers": own_workers,
    "lost-worker": lost_worker,
    "restarted-worker": restarted_worker,
    "replaced-workers": replaced_workers,
}
HOPELESS = "deadly-work"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--cases", nargs="+", choices=[*SURVIVED, HOPELESS], default=[*SURVIVED, HOPELESS])
    parser.add_argument("--rounds", type=int, default=3, help="losses of each kind")
    parser.add_argument("--seed", type=int, default=0, help="seed of the moments")
    parser.add_argument("--root", type=Path, default=None, help="folder for temporary videos and stores")
    parser.add_argument("--frames", type=int, default=16, help="length of the video")
    options = parser.parse_args()
    ledger = Ledger("case", "lost at", "exit code", "artifacts", "computed", "said")
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="moseg-worker-loss-", dir=options.root))
        stack.callback(shutil.rmtree, folder)
        workload = write_workload(folder / "data", options.frames)
        ended = run_to_end(workload.command("eval", str(folder / "whole"), folder / "whole.json"), folder / "logs")
        if ended.code:
            raise RuntimeError(ended.err)
        bench = Bench(workload, folder, read_contents(str(folder / "whole")), random.Random(options.seed))
        for number in range(options.rounds):
            for name in options.cases:
                place = folder / f"{name}-{number}"
                (survive if name in SURVIVED else end)(bench, ledger, name, place / "store")
                shutil.rmtree(place)
    return ledger.close()


def survive(bench: Bench, ledger: Ledger, name: str, store: Path) -> None:
    """Check that the run finishes with undisturbed results."""
    ended, num_stored = SURVIVED[name](bench, store)
    ledger.require(name, "the run finishes", ended.code == 0, (ended.code, ended.err))
    # Python and Dask may warn of resources of the dead process.
    ledger.require(name, "no traceback, no error", "Traceback" not in ended.err and "moseg" not in ended.err, ended.err)
    found = read_contents(str(store))
    ledger.require(name, "all artifacts are those of an undisturbed run", found.results == bench.whole.results)
    ledger.require(name, "nothing is damaged", not found.problems, found.problems)
    computed = read_counts(ended.out)[0] if ended.code == 0 else "-"
    ledger.row(name, f"{num_stored} artifacts", ended.code, len(found.results), computed, one_line(ended))


def end(bench: Bench, ledger: Ledger, name: str, store: Path) -> None:
    """Check that a run whose task kills every worker ends by itself, and that the next one succeeds."""
    ended = bench.start(store, "--workers", "2", env=die_at_task(store.parent / "site", DEADLY)).wait()
    own_words = ended._replace(err="\n".join(line for line in ended.err.splitlines() if not is_of_tracker(line)))
    is_clear = ended.code == 1 and own_words.is_one_line()
    ledger.require(name, "one line, exit code 1", is_clear, (ended.code, ended.err))
    before = read_contents(str(store))
    ledger.require(name, "nothing is damaged", not before.problems, before.problems)
    resumed = bench.start(store, "--workers", "2").wait()
    ledger.require(name, "the same command continues", resumed.code == 0, resumed.err)
    after = read_contents(str(store))
    ledger.require(name, "all artifacts are those of an undisturbed run", after.results == bench.whole.results)
    ledger.row(name, DEADLY, ended.code, len(before.results), "-", one_line(ended))


def is_of_tracker(line: str) -> bool:
    """Return whether a warning is that of Python's tracker of semaphores that killed processes left."""
    return "resource_tracker" in line


def one_line(ended: Ended) -> str:
    """Return what a run printed on standard error, shortened."""
    return " ".join(ended.err.split())[:200]


if __name__ == "__main__":
    sys.exit(main())
