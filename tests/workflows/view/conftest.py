"""Fixtures: a segmented clip of two squares, servers of `moseg view` in processes of their own, and their pages."""

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
COUNTED = {"rows": ".row", "areas": ".row .area", "edits": ".edits li", "rejected": ".rejected li"}
"""Elements of a page that tests wait for: objects, those with their area, corrections and rejected proposals."""
PIXEL = """([x, y]) => {
  const canvas = document.getElementById('picture');
  const at = [Math.round(x * canvas.width), Math.round(y * canvas.height)];
  return [...canvas.getContext('2d').getImageData(...at, 1, 1).data].slice(0, 3);
}"""


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


class ViewPage:
    """A page of Playwright about a result, with what users do there; `faults` are the errors that it reported."""

    def __init__(self, page: Any, wait_until: Callable[..., None]):
        self._page = page
        self._wait_until = wait_until
        self.faults: list[str] = []
        page.on("console", lambda message: self.faults.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: self.faults.append(str(error)))

    def __getattr__(self, name: str) -> Any:
        return getattr(self._page, name)

    def wait_until(self, expression: str) -> None:
        """Wait until an expression is true."""
        self._wait_until(self._page, expression)

    def wait_for(self, **counts: int) -> None:
        """Wait until there are so many of each of `COUNTED` at once."""
        has = (f"document.querySelectorAll('{COUNTED[name]}').length === {count}" for name, count in counts.items())
        self.wait_until(" && ".join(has))

    def edits(self) -> list[str]:
        """Return the corrections in force, as the page lists them."""
        return self.evaluate(f"[...document.querySelectorAll('{COUNTED['edits']}')].map((each) => each.textContent)")

    def pixel(self, x: float, y: float) -> list[int]:
        """Return the RGB levels of the canvas at a share of its width and height."""
        return self.evaluate(PIXEL, [x, y])

    def select(self, *rows: int) -> None:
        """Select the objects in these rows."""
        for place, row in enumerate(rows):
            self.locator(".row").nth(row).locator(".row-name").click(modifiers=["Shift"] if place else [])

    def stroke(self, *shares: tuple[float, float]) -> None:
        """Draw a stroke through places, shares of the picture's width and height."""
        box = self.locator("#picture").bounding_box()
        places = [(box["x"] + x * box["width"], box["y"] + y * box["height"]) for x, y in shares]
        self.mouse.move(*places[0])
        self.mouse.down()
        for place in places[1:]:
            self.mouse.move(*place, steps=4)
        self.mouse.up()

    def export(self, *formats: str) -> str:
        """Export in these formats too, and return what the page says about it."""
        self.get_by_role("button", name="Export…").click()
        for name in formats:
            self.locator(f"input[name=formats][value={name}]").check()
        self.get_by_role("button", name="Write").click()
        self.wait_until("!document.getElementById('write').disabled")
        said = self.locator("#export-status").text_content()
        self.get_by_role("button", name="Close", exact=True).click()
        return said


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


@pytest.fixture
def open_page(new_page, wait_until) -> Callable[..., ViewPage]:
    """Return a function that opens a server's page and waits until its result is drawn."""

    def open_in(server: Server, **options: Any) -> ViewPage:
        page = ViewPage(new_page(viewport={"width": 1280, "height": 800}, **options), wait_until)
        page.goto(server.url)
        page.wait_for_selector("canvas[data-frame]")
        rows, areas = (f"document.querySelectorAll('{COUNTED[name]}').length" for name in ("rows", "areas"))
        page.wait_until(f"{areas} === {rows} && {rows} > 0")
        return page

    return open_in
