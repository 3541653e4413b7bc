"""Requests that an evaluation sends to an object store, as a provider would count and bill them.

Run ``python benchmarks/object_requests.py [--dataset davis16 --root DIR --sequences NAME]``; the default, one small
rendered scene, takes half a minute. The store is a bucket of moto's S3 server on this machine, whose log is counted by
kind of request: of a cold run, of the same run again, and of the commands that list the store. Times would be those of
the test server and are not printed.
"""

import argparse
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple
from urllib.request import Request, urlopen

from engine.commands import MOSEG, run_timed

BUCKET = "benchmark"
START_SECONDS = 60.0
KINDS = ("PUT", "LIST", "GET", "HEAD", "DELETE", "POST")
_LINE = re.compile(r'"(?:\x1b\[[0-9;]*m)*(?P<method>[A-Z]+) (?P<path>\S+) HTTP')
"""A line of the server's log, which colours rejected requests."""


class Server(NamedTuple):
    """A running server: the environment that its clients need, and its log."""

    environ: Mapping[str, str]
    log: Path

    def take(self) -> Counter[str]:
        """Return the requests by kind since the last call."""
        lines = self.log.read_text(errors="replace").splitlines()
        self.log.write_text("")
        found = (_LINE.search(line) for line in lines)
        return Counter(_kind(match["method"], match["path"]) for match in found if match)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--dataset", default="synthetic")
    parser.add_argument("--root", default=None, help="the data set's folder")
    parser.add_argument("--sequences", default="two-motions", help="only these, separated by commas")
    options = parser.parse_args()
    store = ("--store", f"s3://{BUCKET}/store")
    evaluation = ["eval", "--dataset", options.dataset, "--sequences", options.sequences, "--quiet", *store]
    evaluation += ["--root", options.root] if options.root else []
    commands = {"cold run": evaluation, "warm run": evaluation}
    commands |= {"store gc (dry)": ["store", "gc", *store], "store du": ["store", "du", *store]}
    print(f"| command | {' | '.join(KINDS)} |\n|---|{'---|' * len(KINDS)}", flush=True)
    with start_server() as server:
        for name, command in commands.items():
            server.take()
            run_timed([*MOSEG, *command], server.environ)
            counts = server.take()
            print(f"| {name} | {' | '.join(str(counts[kind]) for kind in KINDS)} |", flush=True)
    return 0


@contextmanager
def start_server() -> Iterator[Server]:
    """Start moto's S3 server with an empty bucket, for the block."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"http://127.0.0.1:{port}"
    environ = {
        "AWS_ACCESS_KEY_ID": "benchmark",
        "AWS_SECRET_ACCESS_KEY": "benchmark",
        "AWS_REGION": "us-east-1",
        "AWS_ENDPOINT_URL": address,
        "NO_PROXY": "127.0.0.1",
    }
    folder = Path(tempfile.mkdtemp(prefix="moseg-bench-"))
    log = folder / "server.log"
    with log.open("ab") as output:
        command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)]
        process = subprocess.Popen(command, env=os.environ | environ, stdout=output, stderr=output)
    try:
        _wait_for(process, port)
        with urlopen(Request(f"{address}/{BUCKET}", method="PUT")):
            yield Server(environ, log)
    finally:
        process.terminate()
        process.wait()
        shutil.rmtree(folder)


def _wait_for(process: subprocess.Popen, port: int) -> None:
    end = time.monotonic() + START_SECONDS
    while time.monotonic() < end and process.poll() is None:
        try:
            socket.create_connection(("127.0.0.1", port)).close()
            return
        except ConnectionRefusedError:
            time.sleep(0.05)
    raise TimeoutError("the S3 server does not start")


def _kind(method: str, path: str) -> str:
    """Return the kind as a provider bills it: a GET of a bucket with a query is a listing."""
    is_bucket = "/" not in path.partition("?")[0].strip("/")
    return "LIST" if method == "GET" and is_bucket else method


if __name__ == "__main__":
    sys.exit(main())
