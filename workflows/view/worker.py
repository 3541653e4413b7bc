"""A thread that does one piece of work after the other: the session, its store and its corrections are its own."""

import queue
import threading
from collections.abc import Callable
from concurrent.futures import Future
from enum import IntEnum
from itertools import count
from typing import Any, NamedTuple

END_SECONDS = 5.0
"""Time that a piece of work has to notice that it is to end."""


class Ended(KeyboardInterrupt):
    """An interruption of the work, because the server ends: a run's log records it as interrupted."""


class Turn(IntEnum):
    """Order of the work that waits: what has a lower number comes first."""

    ASKED = 0
    """Somebody waits for it."""
    SPARE = 1
    """It is done while nothing else waits."""
    LAST = 2
    """The end."""


class _Entry(NamedTuple):
    """A piece of work that waits; of one turn, the one with the lower number comes first."""

    turn: Turn
    number: int
    future: Future
    function: Callable[[], Any]


class Worker:
    """A thread and the queue of its work.

    It is a daemon: what does not end in time, such as one long task, is left behind with the process. The store loses
    nothing by that.
    """

    def __init__(self):
        self._waiting: queue.PriorityQueue[_Entry] = queue.PriorityQueue()
        self._numbers = count()
        self._is_ending = threading.Event()
        self._last: Callable[[], None] = lambda: None
        self._thread = threading.Thread(target=self._work, name="moseg-view", daemon=True)
        self._thread.start()

    def call(self, function: Callable[..., Any], *arguments: Any) -> Future:
        """Queue a function behind what the thread was asked for before, and return the future of its result."""
        return self._put(Turn.ASKED, lambda: function(*arguments))

    def spare(self, function: Callable[..., Any], *arguments: Any) -> Future:
        """Queue a function for when nothing else waits, and return the future of its result."""
        return self._put(Turn.SPARE, lambda: function(*arguments))

    def check(self) -> None:
        """Raise Ended if the thread is to end; long work calls it between its parts."""
        if self._is_ending.is_set():
            raise Ended

    def close(self, last: Callable[[], None]) -> None:
        """Drop what waits, and end the thread after a call of `last`; wait for it, at most `END_SECONDS`."""
        self._last = last
        self._is_ending.set()
        self._put(Turn.LAST, lambda: None)
        self._thread.join(END_SECONDS)

    def _put(self, turn: Turn, function: Callable[[], Any]) -> Future:
        future: Future = Future()
        self._waiting.put(_Entry(turn, next(self._numbers), future, function))
        return future

    def _work(self) -> None:
        while (entry := self._waiting.get()).turn is not Turn.LAST:
            future = entry.future
            if self._is_ending.is_set():
                future.cancel()
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(entry.function())
            except BaseException as error:
                future.set_exception(error)
        self._last()
