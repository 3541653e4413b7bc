"""Fixtures: a segmented clip of two squares, and servers of `moseg view` in processes of their own."""

import http.client
import json
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple
from urllib.parse import urlsplit

import pytest

OPTIONS = ("--section-length", "4", "--set", "sections.overlap=2")
PATIENCE_SECONDS = 600


class Segmented(NamedTuple):
    """The frames of a clip, what `moseg segment` wrote of it, and the store with its cues."""

    frames: Path
    out: Path
    store: Path


class Answer(NamedTuple):
    """Status, headers and content of an answer."""

    status: int
    headers: dict[str, str]
    content: bytes

    def json(self) -> Any:
        """Content as JSON."""
        return json.loads(self.content)


class Server:
    """A process of `moseg view`, and requests as its own page makes them."""

    def __init__(self, *arguments: object, cwd: Path | None = None):
        command = [sys.executable, "-m", "moseg", "view", *map(str, arguments), "--no-browser"]
        self.process = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            cwd=cwd,
            start_new_session=True,
            # Processes that a shell runs in the background ignore Ctrl-C.
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
        )
        line = self.process.stdout.readline()
        assert line.startswith("moseg view: http://127.0.0.1:"), (line, self.process.stderr.read())
        self.url = line.split()[-1]
        self.port = urlsplit(self.url).port
        self.root = urlsplit(self.url).path

    @property
    def origin(self) -> str:
        """Origin of its page."""
        return f"http://127.0.0.1:{self.port}"

    def ask(
        self,
        method: str,
        path: str,
        content: Any = None,
        headers: dict[str, str] | None = None,
        root: str | None = None,
    ) -> Answer:
        """Send a request; headers replace those of the page, and are left out where None."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_SECONDS)
        sent = {"Host": f"127.0.0.1:{self.port}", "Origin": self.origin, "Content-Type": "application/json"}
        sent = {name: value for name, value in {**sent, **(headers or {})}.items() if value is not None}
        body = content if isinstance(content, bytes) or content is None else json.dumps(content)
        try:
            connection.putrequest(method, (self.root if root is None else root) + path, skip_host=True)
            for name, value in sent.items():
                connection.putheader(name, value)
            encoded = body.encode() if isinstance(body, str) else body
            if encoded is not None:
                connection.putheader("Content-Length", str(len(encoded)))
            connection.endheaders(encoded)
            response = connection.getresponse()
            return Answer(response.status, {k.lower(): v for k, v in response.getheaders()}, response.read())
        finally:
            connection.close()

    def state(self) -> dict:
        """State of the session."""
        return self.ask("GET", "state").json()

    def wait(self, phase: str) -> dict:
        """Wait for a phase by the server's own events, and return the state."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_SECONDS)
        try:
            connection.request("GET", f"{self.root}events")
            response = connection.getresponse()
            while line := response.readline():
                if line.startswith(b"data:") and json.loads(line[5:]).get("phase") in (phase, "failed"):
                    break
        finally:
            connection.close()
        state = self.state()
        assert state["phase"] == phase, state["message"]
        return state

    def end(self, number: int = signal.SIGTERM) -> tuple[int, str]:
        """End the process by a signal, and return its exit code and standard error."""
        self.process.send_signal(number)
        _, errors = self.process.communicate(timeout=PATIENCE_SECONDS)
        return self.process.returncode, errors


@pytest.fixture(scope="session")
def segmented(write_squares, tmp_path_factory) -> Segmented:
    """Return the segmentation of two squares; tests do not change it."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("viewed")
    frames, out, store = write_squares(folder / "squares") / "frames", folder / "out", folder / "store"
    arguments = ("segment", frames, "--out", out, "--store", store, "--keep-cues", "--quiet", *OPTIONS)
    assert run([str(argument) for argument in arguments]) == 0
    return Segmented(frames, out, store)


@pytest.fixture
def result(segmented, tmp_path) -> Segmented:
    """Return a copy of the segmentation's output folder with the same store, which corrections only add to."""
    shutil.copytree(segmented.out, tmp_path / "out")
    return segmented._replace(out=tmp_path / "out")


@pytest.fixture
def serve() -> Iterator[Callable[..., Server]]:
    """Return a function that starts a server; all are killed at the end of the test."""
    with _servers() as start:
        yield start


@pytest.fixture(scope="module")
def empty_server(tmp_path_factory) -> Iterator[Server]:
    """Return a server about nothing yet, the same one for all tests of a module."""
    folder = tmp_path_factory.mktemp("empty")
    with _servers() as start:
        yield start("--out", folder / "out", "--store", folder / "store", "--quiet")


@contextmanager
def _servers() -> Iterator[Callable[..., Server]]:
    started: list[Server] = []

    def start(*arguments: object, cwd: Path | None = None) -> Server:
        started.append(Server(*arguments, cwd=cwd))
        return started[-1]

    yield start
    for server in started:
        if server.process.poll() is None:
            server.process.kill()
        server.process.communicate()


@pytest.fixture
def serve_video(serve, result) -> Callable[..., Server]:
    """Return a function that starts a server about the squares, and waits until they are open."""

    def start(*more: object, frames: Path = result.frames) -> Server:
        server = serve(frames, "--out", result.out, "--store", result.store, *OPTIONS, *more)
        server.wait("ready")
        return server

    return start
