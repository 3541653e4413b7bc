"""Cost of calls that do nothing, through a scheduler to one worker and back, in each process."""

from pathlib import Path
from typing import NamedTuple

import psutil
from engine.own_cluster import start_cluster

from moseg.workflows.cluster.call import Call
from moseg.workflows.cluster.runners import open_runner

NUM_FIRST = 100
"""Number of calls beforehand, which include connections and imports."""


class CallCost(NamedTuple):
    """Cost in one process: CPU seconds per call, and bytes by which all calls increased its memory."""

    cpu: float
    grown: int


def measure_calls(num_calls: int, folder: Path) -> dict[str, CallCost]:
    """Return the cost of so many calls in client, scheduler and worker; Dask writes its files to `folder`."""
    with start_cluster(1, folder) as cluster, open_runner(scheduler=cluster.address) as runner:

        def run(count: int, name: str) -> None:
            runner.run((Call(f"{name}-{number}", abs, (number,)) for number in range(count)), lambda *_: None)

        run(NUM_FIRST, "first")
        pids = {"client": None, "scheduler": cluster.scheduler, "worker": cluster.workers[0]}
        processes = {role: psutil.Process(pid) for role, pid in pids.items()}
        before = {role: _usage(process) for role, process in processes.items()}
        run(num_calls, "empty")
        after = {role: _usage(process) for role, process in processes.items()}
    return {
        role: CallCost((after[role][0] - before[role][0]) / num_calls, after[role][1] - before[role][1])
        for role in processes
    }


def _usage(process: psutil.Process) -> tuple[float, int]:
    with process.oneshot():
        used = process.cpu_times()
        return used.user + used.system, process.memory_info().rss
