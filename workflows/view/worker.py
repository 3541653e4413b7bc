"""A thread that does one piece of work after the other: the session, its store and its corrections are its own."""

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

END_SECONDS = 5.0
"""Time that a piece of work has to notice that it is to end."""


class Ended(KeyboardInterrupt):
    """An interruption of the work, because the server ends: a run's log records it as interrupted."""


class Worker:
    """A thread and the queue of its work.

    It is a daemon: what does not end in time, such as one long task, is left behind with the process. The store loses
    nothing by that.
    """

    def __init__(self):
        self._waiting: queue.SimpleQueue[tuple[Future, Callable[[], Any]] | None] = queue.SimpleQueue()
        self._is_ending = threading.Event()
        self._last: Callable[[], None] = lambda: None
        self._thread = threading.Thread(target=self._work, name="moseg-view", daemon=True)
        self._thread.start()

    def call(self, function: Callable[..., Any], *arguments: Any) -> Future:
        """Have the thread call a function, after what it was given before, and return the future of its result."""
        future: Future = Future()
        self._waiting.put((future, lambda: function(*arguments)))
        return future

    def check(self) -> None:
        """Raise Ended if the thread is to end; long work calls it between its parts."""
        if self._is_ending.is_set():
            raise Ended

    def close(self, last: Callable[[], None]) -> None:
        """Have the thread drop what waits, call `last`, and end; return when it has, or after `END_SECONDS`."""
        self._last = last
        self._is_ending.set()
        self._waiting.put(None)
        self._thread.join(END_SECONDS)

    def _work(self) -> None:
        while (entry := self._waiting.get()) is not None:
            future, function = entry
            if self._is_ending.is_set():
                future.cancel()
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(function())
            except BaseException as error:
                future.set_exception(error)
        self._last()
