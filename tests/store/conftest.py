"""Fixtures: a new store, toy artifacts whose task has no layout in the schemas, and an S3 server."""

import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import closing
from http.client import HTTPConnection
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from moseg.schemas.recipes import Recipe
from moseg.store import LocalStore

BUCKET = "moseg-tests"
# Only the application of S3: the server of all services takes longer to find a request's service than to answer it.
SERVE = """
import sys

from moto.server import MotoRequestHandler, create_backend_app
from werkzeug.serving import run_simple

MotoRequestHandler.protocol_version = "HTTP/1.1"  # keeps connections open
port = int(sys.argv[1])
run_simple("127.0.0.1", port, create_backend_app("s3"), threaded=True, request_handler=MotoRequestHandler)
"""
START_SECONDS = 600


class Server(NamedTuple):
    """The address of a server, and the environment in which a process finds it."""

    endpoint: str
    environment: dict[str, str]


@pytest.fixture
def store(tmp_path: Path) -> LocalStore:
    return LocalStore(tmp_path / "store")


@pytest.fixture
def put_toy() -> Callable[..., str]:
    """Put an artifact of task ``toy`` with one array ``x`` and return its reference."""

    def put(target, number: int = 0, inputs: dict | None = None, array: np.ndarray | None = None) -> str:
        recipe = Recipe(task="toy", version=1, params={"number": number}, inputs=inputs or {})
        array = np.arange(6.0).reshape(2, 3) + number if array is None else array
        target.put(recipe, {"x": array}, dims={"x": tuple("abcdef"[: array.ndim])})
        return recipe.ref

    return put


@pytest.fixture(scope="session")
def s3_server() -> Iterator[Server]:
    """Start a process on this machine that emulates S3, with one bucket."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    environment = {
        "AWS_ACCESS_KEY_ID": "test-key",
        "AWS_SECRET_ACCESS_KEY": "test-secret",
        "AWS_REGION": "us-east-1",
        "AWS_ENDPOINT_URL": f"http://127.0.0.1:{port}",
        "NO_PROXY": "127.0.0.1",
        "no_proxy": "127.0.0.1",
    }
    command = [sys.executable, "-c", SERVE, str(port)]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    process = subprocess.Popen(command, env=os.environ | environment, **quiet)
    try:
        deadline = time.monotonic() + START_SECONDS
        while True:
            try:
                socket.create_connection(("127.0.0.1", port)).close()
                break
            except ConnectionRefusedError:
                assert process.poll() is None and time.monotonic() < deadline, "the S3 server does not start"
                time.sleep(0.05)
        with closing(HTTPConnection("127.0.0.1", port)) as connection:
            connection.request("PUT", f"/{BUCKET}")
            assert connection.getresponse().status == 200
        yield Server(environment["AWS_ENDPOINT_URL"], environment)
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def s3(s3_server, tmp_path, monkeypatch) -> str:
    """Return the URL of an empty prefix that this process can write."""
    _use(s3_server, monkeypatch)
    return f"s3://{BUCKET}/{tmp_path.name}"


@pytest.fixture(scope="module")
def pushed(evaluated, s3_server) -> str:
    """Push the evaluated squares to an object store and return its URL, which tests that use `s3` can read."""
    from moseg.workflows.cli.app import run

    url = f"s3://{BUCKET}/pushed"
    with pytest.MonkeyPatch.context() as monkeypatch:
        _use(s3_server, monkeypatch)
        assert run(["store", "push", url, "--quiet", "--store", str(evaluated.store)]) == 0
    return url


def _use(server: Server, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in [name for name in os.environ if name.startswith("AWS_")]:
        monkeypatch.delenv(name)
    for name, value in server.environment.items():
        monkeypatch.setenv(name, value)
