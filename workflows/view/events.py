"""Events that the server sends to all open pages, as server-sent events."""

import asyncio
import json
from collections.abc import AsyncIterator
from typing import Any

HEARTBEAT_SECONDS = 15.0
"""A comment in this interval lets a connection that is gone be noticed."""


class Events:
    """The pages that listen, and what they are sent.

    An event replaces an earlier one of the same name that a slow page has not read yet.
    """

    def __init__(self):
        self._loop: asyncio.AbstractEventLoop | None = None
        self._latest: dict[str, str] = {}
        self._listeners: set[_Listener] = set()
        self._is_closed = False

    def attach(self) -> None:
        """Bind to the loop that runs now; events of before are kept for the pages to come."""
        self._loop = asyncio.get_running_loop()

    def send(self, name: str, data: Any) -> None:
        """Send an event to all pages; may be called in any thread."""
        text = json.dumps(data)
        if self._loop is None:
            self._latest[name] = text
        elif not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._spread, name, text)

    def close(self) -> None:
        """End all streams; may be called in any thread, or in a signal handler."""
        if self._loop is not None and not self._loop.is_closed():
            self._loop.call_soon_threadsafe(self._end)

    async def stream(self) -> AsyncIterator[bytes]:
        """Yield the latest event of each name, then events as they come, until the server ends."""
        listener = _Listener(dict(self._latest), asyncio.Event())
        listener.is_due.set()
        self._listeners.add(listener)
        try:
            while not self._is_closed:
                try:
                    await asyncio.wait_for(listener.is_due.wait(), HEARTBEAT_SECONDS)
                except TimeoutError:
                    yield b": still here\n\n"
                    continue
                listener.is_due.clear()
                pending = list(listener.pending.items())
                listener.pending.clear()
                for name, text in pending:
                    yield f"event: {name}\ndata: {text}\n\n".encode()
        finally:
            self._listeners.discard(listener)

    def _spread(self, name: str, text: str) -> None:
        self._latest[name] = text
        for listener in self._listeners:
            listener.pending[name] = text
            listener.is_due.set()

    def _end(self) -> None:
        self._is_closed = True
        for listener in self._listeners:
            listener.is_due.set()


class _Listener:
    """Events that one page has not read yet, by name."""

    def __init__(self, pending: dict[str, str], is_due: asyncio.Event):
        self.pending = pending
        self.is_due = is_due
