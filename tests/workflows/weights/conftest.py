"""A file server on this machine that misbehaves on demand, and folders of weights that point to it."""

import hashlib
import json
import re
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from moseg.workflows.weights.folder import Weights, open_weights


@dataclass
class Answer:
    """The response of a path: bytes in ranges, or something else."""

    content: bytes = b""
    status: int = 200
    content_type: str = "application/octet-stream"
    etag: str | None = None
    knows_ranges: bool = True
    heeds_if_range: bool = True
    headers: dict[str, str] = field(default_factory=dict)
    """Headers added to the others, or replacing them."""
    has_length: bool = True
    cuts: list[int] = field(default_factory=list)
    """Bytes after which the first, second … answer is cut off."""
    location: str = ""
    gate: threading.Event | None = None
    """Event that is awaited before the body is sent."""


@dataclass
class Request:
    """A request, and how many bytes of a body were sent."""

    path: str
    headers: dict[str, str]
    num_sent: int = 0


class FileServer:
    """A server with a response for each path; everything else is 404."""

    def __init__(self):
        self.answers: dict[str, Answer] = {}
        self.requests: list[Request] = []
        self.arrived = threading.Event()
        self._idle = threading.Condition()
        self._num_active = 0
        self._http = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        self._http.daemon_threads = True
        self._thread = threading.Thread(target=self._http.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True)
        self._thread.start()
        self.url = f"http://127.0.0.1:{self._http.server_port}"

    def serve(self, path: str, content: bytes, **options) -> str:
        """Serve a file at a path; return its address."""
        self.answers[path] = Answer(content, **options)
        return self.url + path

    def num_sent(self, path: str) -> int:
        """Return the bytes of bodies sent for a path, once every response is complete."""
        # A client may have read the last byte before the server's thread counts it.
        with self._idle:
            assert self._idle.wait_for(lambda: not self._num_active, timeout=600)
        return sum(request.num_sent for request in self.requests if request.path == path)

    def close(self) -> None:
        self._http.shutdown()
        self._thread.join()
        self._http.server_close()

    def _handler(self):
        server = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                with server._idle:
                    server._num_active += 1
                try:
                    self._answer()
                finally:
                    with server._idle:
                        server._num_active -= 1
                        server._idle.notify_all()

            def _answer(self):
                request = Request(self.path, {key.lower(): value for key, value in self.headers.items()})
                server.requests.append(request)
                server.arrived.set()
                answer = server.answers.get(self.path, Answer(b"not here", status=404))
                status, body, headers = server._range(answer, request)
                self.send_response(status)
                for name, value in {**headers, **answer.headers}.items():
                    self.send_header(name, value)
                self.end_headers()
                if answer.gate is not None:
                    answer.gate.wait(600)
                if answer.cuts:
                    body = body[: answer.cuts.pop(0)]
                self.wfile.write(body)
                request.num_sent = len(body)
                self.close_connection = True

            def log_message(self, *arguments):
                pass

        return Handler

    @staticmethod
    def _range(answer: Answer, request: Request) -> tuple[int, bytes, dict[str, str]]:
        headers = {"Content-Type": answer.content_type, "Connection": "close"}
        if answer.etag:
            headers["ETag"] = answer.etag
        if answer.location:
            return 302, b"", headers | {"Location": answer.location, "Content-Length": "0"}
        status, body = answer.status, answer.content
        asked = re.fullmatch(r"bytes=(\d+)-", request.headers.get("range", ""))
        is_same = not answer.heeds_if_range or request.headers.get("if-range", answer.etag) == answer.etag
        if asked and status == 200 and answer.knows_ranges and is_same:
            start, total = int(asked[1]), len(body)
            if start >= total:
                return 416, b"", headers | {"Content-Range": f"bytes */{total}", "Content-Length": "0"}
            status, body = 206, body[start:]
            headers["Content-Range"] = f"bytes {start}-{total - 1}/{total}"
        if answer.has_length:
            headers["Content-Length"] = str(len(body))
        return status, body, headers


@pytest.fixture
def server() -> Iterator[FileServer]:
    """Yield a file server on the loopback interface."""
    running = FileServer()
    yield running
    running.close()


@pytest.fixture
def no_waiting(monkeypatch) -> list[float]:
    """Repeat requests at once; return a list of the waits that were skipped, s."""
    waits: list[float] = []
    monkeypatch.setattr("moseg.workflows.weights.download.time.sleep", waits.append)
    return waits


@pytest.fixture
def sha256() -> Callable[[bytes], str]:
    """Return a function that gives the hexadecimal SHA-256."""
    return lambda content: hashlib.sha256(content).hexdigest()


@pytest.fixture
def folder(tmp_path) -> Path:
    """Return the folder that `$MOSEG_WEIGHTS` names, which does not exist yet."""
    return tmp_path / "weights"


@pytest.fixture
def describe(folder) -> Callable[..., None]:
    """Return a function that writes ``weights.json`` with items as dictionaries; an item needs only files."""

    def write(*items: dict) -> None:
        folder.mkdir(exist_ok=True)
        described = [{"name": "net", "architecture": "raft", **item} for item in items]
        (folder / "weights.json").write_text(json.dumps({"items": described}))

    return write


@pytest.fixture
def open_folder(folder) -> Callable[..., Weights]:
    """Return a function that opens the folder; further environment variables are given by name."""

    def opened(
        offline: bool = False,
        allow_non_commercial: bool = False,
        quiet: bool = True,
        accept_licence: str | None = None,
        check_licences: bool = True,
        **variables,
    ) -> Weights:
        env = {"MOSEG_WEIGHTS": str(folder), **variables}
        return open_weights(env, offline, allow_non_commercial, quiet, accept_licence, check_licences)

    return opened
