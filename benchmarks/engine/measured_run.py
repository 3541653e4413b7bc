"""Cost of one evaluation of tiny videos on a cluster of its own."""

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

import psutil
from engine.commands import MOSEG, run_timed
from engine.memory_samples import MemorySamples
from engine.own_cluster import start_cluster
from engine.tiny_videos import write_videos

from moseg.store import LocalStore


class Peaks(NamedTuple):
    """Largest resident memory by role, bytes; for workers, that of the largest one."""

    client: int
    scheduler: int
    worker: int


class Cost(NamedTuple):
    """Cost of one run.

    Attributes
    ----------
    wall, cpu : float
        Wall-clock seconds, and CPU seconds of client, scheduler and workers.
    warm : float
        Wall-clock seconds of the same run again, without a cluster.
    peaks : Peaks
    num_artifacts, nbytes : int
        Artifacts and bytes in its store.
    """

    wall: float
    cpu: float
    warm: float
    peaks: Peaks
    num_artifacts: int
    nbytes: int


def measure(num_videos: int, per_video: int, size: tuple[int, int], workers: int, scratch: Path) -> Cost:
    """Return the cost of evaluating so many videos of so many pairs on an empty store."""
    folder = scratch / f"run-{num_videos}x{per_video}"
    write_videos(folder / "videos", num_videos, per_video, size)
    store = folder / "artifacts"
    command = [
        *MOSEG,
        "eval",
        "--dataset",
        "folder",
        "--root",
        str(folder / "videos"),
        "--store",
        str(store),
        "--quiet",
    ]
    try:
        with start_cluster(workers, folder) as cluster:
            others = [psutil.Process(pid) for pid in (cluster.scheduler, *cluster.workers)]
            before = sum(map(_cpu_seconds, others))
            start = time.perf_counter()
            with (folder / "client.log").open("wb") as output:
                client = subprocess.Popen(
                    [*command, "--scheduler", cluster.address], stdout=output, stderr=subprocess.STDOUT
                )
            samples = MemorySamples([client.pid, cluster.scheduler, *cluster.workers])
            samples.start()
            # Not the process's own wait, which does not return the child's usage.
            _, status, used = os.wait4(client.pid, 0)
            wall = time.perf_counter() - start
            client_peak, scheduler_peak, *worker_peaks = samples.stop()
            client.returncode = os.waitstatus_to_exitcode(status)
            if client.returncode:
                print((folder / "client.log").read_text(), file=sys.stderr)
                raise subprocess.CalledProcessError(client.returncode, command)
            cpu = used.ru_utime + used.ru_stime + sum(map(_cpu_seconds, others)) - before
        warm = run_timed(command)
        usage = LocalStore(store, create=False).usage().values()
    finally:
        shutil.rmtree(folder)
    counts = sum(each.num_artifacts for each in usage), sum(each.nbytes for each in usage)
    return Cost(wall, cpu, warm, Peaks(client_peak, scheduler_peak, max(worker_peaks)), *counts)


def _cpu_seconds(process: psutil.Process) -> float:
    used = process.cpu_times()
    return used.user + used.system
