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
    command = [sys.executable, "-m", "moto.server", "-H", "127.0.0.1", "-p", str(port)]
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
    for name in [name for name in os.environ if name.startswith("AWS_")]:
        monkeypatch.delenv(name)
    for name, value in s3_server.environment.items():
        monkeypatch.setenv(name, value)
    return f"s3://{BUCKET}/{tmp_path.name}"
