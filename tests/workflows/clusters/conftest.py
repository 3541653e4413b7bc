"""Clusters of real processes, as a user starts them: `dask scheduler` and `dask worker`."""

import os
import re
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from distributed import LocalCluster

from moseg.workflows.cluster.tls_files import TlsFiles

DEADLINE_SEC = 600


class Cluster:
    """A scheduler on loopback, and workers, each a process of its own."""

    def __init__(self, folder: Path):
        self._folder = folder
        self._processes: dict[str, subprocess.Popen] = {}
        self._tls: list[str] = []
        self._held: LocalCluster | None = None

    def start_scheduler(self, tls: TlsFiles | None = None, path: Path | None = None) -> None:
        """Start it as a process, with a folder in front of its modules."""
        protocol = "tls" if tls else "tcp"
        with socket.create_server(("127.0.0.1", 0)) as server:
            self.address = f"{protocol}://127.0.0.1:{server.getsockname()[1]}"
        files = {"ca-file": tls.ca, "cert": tls.cert, "key": tls.key} if tls else {}
        self._tls = [word for name, path in files.items() for word in (f"--tls-{name}", path)]
        file = self._folder / "scheduler.json"
        options = ("--host", self.address, "--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(file))
        self.scheduler = self._start("scheduler", *options, path=path)
        self.file = file
        # It is written in place: until its end is there it says nothing.
        _wait(lambda: file.exists() and file.read_text().rstrip().endswith("}"), self.log)

    def hold_scheduler(self) -> None:
        """Have it in this process, which takes a tenth of the time."""
        where = {"host": "127.0.0.1", "dashboard_address": "127.0.0.1:0"}
        self._held = LocalCluster(n_workers=0, processes=True, silence_logs="CRITICAL", **where)
        self.address = self._held.scheduler_address

    def add_worker(self, name: str, *options: str, path: Path | None = None, has_nanny: bool = False):
        """Start a worker, with a folder in front of its modules, and wait until it has joined."""
        nanny = "--nanny" if has_nanny else "--no-nanny"
        fixed = ("--nthreads", "1", "--host", "127.0.0.1", "--no-dashboard", "--local-directory", str(self._folder))
        process = self._start("worker", self.address, *fixed, nanny, "--name", name, *options, path=path)
        _wait(lambda: "Registered to" in self.log(name), lambda: self.log(name))
        return process

    def end_others(self, kept: str) -> None:
        """End all workers but one, and wait until the scheduler of this process knows it."""
        for name in [name for name in self._processes if name != kept]:
            self._end(name)
        _wait(lambda: len(self._held.scheduler_info["workers"]) == 1, lambda: "a worker did not go")

    def worker_address(self, name: str) -> str:
        """Where a worker says that it listens."""
        return re.search(r"Start worker at: +(\S+)", self.log(name)).group(1)

    def log(self, name: str = "scheduler") -> str:
        """What a process has said so far."""
        return (self._folder / f"{name}.log").read_text()

    def close(self) -> None:
        """End every process."""
        for name in reversed([*self._processes]):
            self._end(name)
        if self._held is not None:
            self._held.close()

    def _end(self, name: str) -> None:
        process = self._processes.pop(name)
        process.kill()
        process.wait(timeout=DEADLINE_SEC)

    def _start(self, kind: str, *words: str, path: Path | None = None) -> subprocess.Popen:
        name = words[words.index("--name") + 1] if "--name" in words else kind
        places = [str(path)] if path else []
        # Workers ignore the folder that they are started in.
        env = os.environ | {"PYTHONPATH": os.pathsep.join(places)}
        command = [sys.executable, "-m", f"distributed.cli.dask_{kind}", *words, *self._tls]
        with (self._folder / f"{name}.log").open("w") as log:
            process = subprocess.Popen(command, env=env, stdout=log, stderr=log, cwd=self._folder)
        self._processes[name] = process
        return process


def _wait(is_done: Callable[[], bool], explain: Callable[[], str]) -> None:
    deadline = time.monotonic() + DEADLINE_SEC
    while not is_done():
        assert time.monotonic() < deadline, explain()
        time.sleep(0.02)


@pytest.fixture(scope="session")
def make_cluster() -> type[Cluster]:
    """Makes a cluster whose files lie in a folder."""
    return Cluster


@pytest.fixture
def new_cluster(tmp_path) -> Iterator[Callable[[], Cluster]]:
    """Makes a cluster without a scheduler, which ends with the test."""
    made = []

    def make() -> Cluster:
        folder = tmp_path / f"cluster-{len(made)}"
        folder.mkdir()
        made.append(Cluster(folder))
        return made[-1]

    yield make
    for cluster in made:
        cluster.close()


@pytest.fixture
def start_cluster(new_cluster) -> Callable[..., Cluster]:
    """Starts a scheduler, a process without workers."""

    def start(tls: TlsFiles | None = None, path: Path | None = None) -> Cluster:
        cluster = new_cluster()
        cluster.start_scheduler(tls, path)
        return cluster

    return start


@pytest.fixture
def cluster(new_cluster) -> Cluster:
    """A scheduler without workers."""
    cluster = new_cluster()
    cluster.hold_scheduler()
    return cluster


@pytest.fixture(scope="module")
def _with_a_worker(tmp_path_factory) -> Iterator[Cluster]:
    cluster = Cluster(tmp_path_factory.mktemp("cluster"))
    cluster.hold_scheduler()
    try:
        cluster.add_worker("same")
        yield cluster
    finally:
        cluster.close()


@pytest.fixture
def with_a_worker(_with_a_worker) -> Iterator[Cluster]:
    """The cluster of the module's tests, with a worker ``same``; those that a test adds end with it."""
    yield _with_a_worker
    _with_a_worker.end_others("same")


@pytest.fixture(scope="session")
def make_tls(tmp_path_factory) -> Callable[[str], TlsFiles]:
    """Writes the certificate of a new authority, and one that it gives to loopback, with its key."""
    trustme = pytest.importorskip("trustme")

    def make(name: str) -> TlsFiles:
        folder = tmp_path_factory.mktemp(name)
        authority = trustme.CA()
        certificate = authority.issue_cert("127.0.0.1")
        files = TlsFiles(*(str(folder / f"{part}.pem") for part in ("ca", "cert", "key")))
        authority.cert_pem.write_to_path(files.ca)
        certificate.private_key_pem.write_to_path(files.key)
        for blob in certificate.cert_chain_pems:
            blob.write_to_path(files.cert, append=True)
        return files

    return make


@pytest.fixture(scope="session")
def tls_files(make_tls) -> TlsFiles:
    """Certificates that client, scheduler and workers share."""
    return make_tls("tls")
