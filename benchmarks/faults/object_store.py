"""An S3 server on this machine that can hold a request, so that a client dies while it waits for the answer."""

import logging
import os
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from urllib.request import Request, urlopen

from moto.server import DomainDispatcherApplication, create_backend_app
from werkzeug.serving import make_server

BUCKET = "moseg"


class ObjectServer:
    """A server of S3 requests that can hold one of those that write; see `hold_write`."""

    def __init__(self) -> None:
        self._serve: Callable[..., Iterable[bytes]] = DomainDispatcherApplication(create_backend_app)
        self._lock = threading.Lock()
        self._left = 0
        self._is_dropped = False
        self._held, self._released = threading.Event(), threading.Event()

    def __call__(self, environ: dict, start_response: Callable) -> Iterable[bytes]:
        """Answer a request (WSGI)."""
        if environ["REQUEST_METHOD"] == "PUT":
            with self._lock:
                self._left -= 1
                is_chosen = self._left == 0
            if is_chosen:
                self._held.set()
                self._released.wait()
                if self._is_dropped:
                    start_response("503 Service Unavailable", [])
                    return []
        return self._serve(environ, start_response)

    @property
    def url(self) -> str:
        """Return the URL of the bucket."""
        return f"s3://{BUCKET}"

    @property
    def is_holding(self) -> bool:
        """Return whether the chosen request has arrived and waits."""
        return self._held.is_set()

    def hold_write(self, number: int) -> None:
        """Hold the n-th object that is written from now on, until `release`."""
        with self._lock:
            self._left = number
            self._held.clear()
            self._released.clear()

    def release(self, drop: bool) -> None:
        """Write the held object, or drop it as if it had not arrived completely; hold nothing any more."""
        with self._lock:
            self._left = 0
            self._is_dropped = drop
            self._released.set()


@contextmanager
def serve_objects() -> Iterator[ObjectServer]:
    """Serve an empty bucket for the block; processes that are started in it find it by their environment."""
    logging.getLogger("werkzeug").setLevel(logging.ERROR)
    objects = ObjectServer()
    server = make_server("127.0.0.1", 0, objects, threaded=True)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        os.environ |= {
            "AWS_ENDPOINT_URL": f"http://127.0.0.1:{server.port}",
            "AWS_ACCESS_KEY_ID": "nobody",
            "AWS_SECRET_ACCESS_KEY": "nothing",
            "AWS_REGION": "us-east-1",
            "NO_PROXY": "127.0.0.1",
        }
        urlopen(Request(f"http://127.0.0.1:{server.port}/{BUCKET}", method="PUT")).close()
        yield objects
    finally:
        server.shutdown()
        thread.join()
