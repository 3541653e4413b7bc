"""Dask scheduler and workers as processes of their own, so that the memory of each role can be measured separately."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import NamedTuple

from distributed import Client

from moseg.workflows.process.resources import allocation_environ, thread_environ

START_SECONDS = 60.0
"""Time limit for the start of a scheduler and of its workers."""


class OwnCluster(NamedTuple):
    """Address of a cluster and the process numbers of its scheduler and its workers."""

    address: str
    scheduler: int
    workers: tuple[int, ...]


@contextmanager
def start_cluster(num_workers: int, folder: Path) -> Iterator[OwnCluster]:
    """Start a scheduler and workers of one thread each for the block, with the settings of `moseg`'s local workers.

    Dask's files and the output of the processes are written to `folder`.
    """
    environ = {**os.environ, **thread_environ(1), **allocation_environ()}
    environ["DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED"] = "False"
    found = folder / "scheduler.json"
    local = ["--no-dashboard", "--host", "127.0.0.1"]
    with ExitStack() as stack:

        def start(module: str, *arguments: str) -> subprocess.Popen:
            output = stack.enter_context((folder / f"{module}.log").open("ab"))
            command = [sys.executable, "-m", f"distributed.cli.{module}", *arguments, *local]
            process = subprocess.Popen(command, stdout=output, stderr=output, env=environ, cwd=folder)
            stack.callback(process.wait)
            stack.callback(process.terminate)
            return process

        scheduler = start("dask_scheduler", "--port", "0", "--scheduler-file", str(found))
        address = _read_address(found, scheduler)
        options = ("--nthreads", "1", "--no-nanny", "--memory-limit", "0", "--local-directory", str(folder))
        workers = [start("dask_worker", address, *options) for _ in range(num_workers)]
        with Client(address) as client:
            client.wait_for_workers(num_workers, timeout=START_SECONDS)
        yield OwnCluster(address, scheduler.pid, tuple(worker.pid for worker in workers))


def _read_address(path: Path, scheduler: subprocess.Popen) -> str:
    end = time.monotonic() + START_SECONDS
    while time.monotonic() < end and scheduler.poll() is None:
        if path.exists() and (content := path.read_text()):
            return json.loads(content)["address"]
        time.sleep(0.05)
    raise TimeoutError(f"no scheduler within {START_SECONDS:.0f} s; see the logs in {path.parent}")
