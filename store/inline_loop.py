"""Running Zarr's coroutines on the calling thread.

Zarr's synchronous interface runs every call on one thread and every chunk's codec in a pool. For arrays of a few
kilobytes these switches take most of the time, on busy cores nearly all of it, and a worker limited to one thread would
have six more.
"""

import asyncio
import atexit
from collections import deque
from collections.abc import Callable, Coroutine
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any, TypeVar

T = TypeVar("T")

_idle: deque[asyncio.AbstractEventLoop] = deque()


def run_inline(coroutine: Coroutine[Any, Any, T]) -> T:
    """Run a coroutine to its end on this thread, including the work that it submits to threads.

    If an event loop runs already, as in a notebook, another thread is used.
    """
    if not _is_loop_running():
        return _run(coroutine)
    with ThreadPoolExecutor(max_workers=1) as pool:
        return pool.submit(_run, coroutine).result()


class _CallingThread(ThreadPoolExecutor):
    """An executor that runs each submitted call immediately (asyncio accepts only thread pools as default executor)."""

    def submit(self, function: Callable[..., T], /, *args: Any, **kwargs: Any) -> "Future[T]":
        future: Future[T] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except BaseException as error:
            future.set_exception(error)
        return future


def _run(coroutine: Coroutine[Any, Any, T]) -> T:
    # loops are reused: making one takes as long as reading a small array
    try:
        loop = _idle.pop()
    except IndexError:
        loop = asyncio.new_event_loop()
        loop.set_default_executor(_CallingThread(max_workers=1))
    try:
        return loop.run_until_complete(coroutine)
    except BaseException:
        # one of several chunks failed: the others must not continue in the next call
        loop.run_until_complete(_cancel_all())
        raise
    finally:
        _idle.append(loop)


async def _cancel_all() -> None:
    tasks = asyncio.all_tasks() - {asyncio.current_task()}
    for task in tasks:
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


def _is_loop_running() -> bool:
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return False
    return True


def _close_idle() -> None:
    while _idle:
        _idle.pop().close()


atexit.register(_close_idle)
