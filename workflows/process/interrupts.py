"""Interrupts (Ctrl-C, SIGTERM) while worker processes are started."""

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker


@contextmanager
def defer_interrupts() -> Iterator[None]:
    """Raise an interrupt of the block at its end; threads and processes that it starts never receive Ctrl-C.

    Ctrl-C reaches the whole process group, and a cluster or a worker that is half started prints traces on it.
    Outside the main thread there is nothing to defer.
    """
    if threading.current_thread() is not threading.main_thread() or not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Its start removes the signal mask of the calling thread.
    resource_tracker.ensure_running()
    interrupted, terminated = threading.Event(), threading.Event()
    previous = signal.signal(signal.SIGINT, lambda number, frame: interrupted.set())
    ending = signal.getsignal(signal.SIGTERM)
    # Not masked: what starts worker processes ends them by this signal.
    if callable(ending):
        signal.signal(signal.SIGTERM, lambda number, frame: terminated.set())
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        signal.signal(signal.SIGINT, previous)
        if callable(ending):
            signal.signal(signal.SIGTERM, ending)
    if terminated.is_set():
        ending(signal.SIGTERM, None)
    if interrupted.is_set():
        raise KeyboardInterrupt
