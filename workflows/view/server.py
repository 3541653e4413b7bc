"""The server: one address on this machine, until the user ends it."""

import secrets
import socket
import sys
import threading
import webbrowser
from collections.abc import Callable
from typing import NamedTuple

import uvicorn

from moseg.schemas.errors import InputError
from moseg.workflows.view.application import ViewApplication
from moseg.workflows.view.guard import Guard
from moseg.workflows.view.view_session import ViewSession

HOST = "127.0.0.1"
"""No other machine reaches it."""
SWITCH_SECONDS = 0.0005
"""Time that a thread of Python keeps the interpreter while others wait.

A change reads and writes many small files, and waits for the interpreter after each: with the default of 5 ms, each of
these waits could last as long, while another thread draws pictures."""
GRACE_SECONDS = 2
"""Time that answers under way have when the server ends."""


class Address(NamedTuple):
    """A socket that is bound, and the token without which it answers nothing."""

    socket: socket.socket
    token: str

    @property
    def port(self) -> int:
        """Port of the socket."""
        return self.socket.getsockname()[1]

    @property
    def url(self) -> str:
        """Address for the user's browser."""
        return f"http://{HOST}:{self.port}/{self.token}/"


def bind(port: int = 0) -> Address:
    """Bind a port of this machine, any free one for 0; raises InputError if it is in use."""
    # Only if the protocol is named, asyncio sends small answers at once (TCP_NODELAY), and not 40 ms later.
    bound = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        bound.bind((HOST, port))
        bound.listen()
    except OSError as error:
        bound.close()
        got = f"{port} ({error.strerror})"
        raise InputError("no such port free", where="--port", got=got, expected="another one, or 0 for any") from error
    return Address(bound, secrets.token_urlsafe(24))


def serve(address: Address, session: ViewSession, application: ViewApplication, has_browser: bool) -> None:
    """Answer requests until Ctrl-C or SIGTERM, which are raised again once all is closed."""
    app = Guard(application.routes(), address.token, address.port)
    config = uvicorn.Config(
        app,
        log_config=None,
        access_log=False,
        server_header=False,
        date_header=False,
        lifespan="on",
        ws="none",
        timeout_graceful_shutdown=GRACE_SECONDS,
    )
    sys.setswitchinterval(SWITCH_SECONDS)
    opened = (lambda: _open_browser(address.url)) if has_browser else (lambda: None)
    with address.socket:
        _Server(config, session, opened).run(sockets=[address.socket])


def _open_browser(url: str) -> None:
    # In a thread: a browser of the terminal does not return before it is left, and asks the server meanwhile.
    threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()


class _Server(uvicorn.Server):
    """A server that ends the streams of events with itself, and opens a browser once it answers."""

    def __init__(self, config: uvicorn.Config, session: ViewSession, opened: Callable[[], object]):
        super().__init__(config)
        self._session, self._opened = session, opened

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._opened()

    def handle_exit(self, sig: int, frame: object) -> None:
        self._session.events.close()
        super().handle_exit(sig, frame)
