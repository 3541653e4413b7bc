"""Running Zarr's coroutines on the calling thread.

Zarr's synchronous interface hands every call to one thread and every chunk's codec to a pool. For arrays of a few
kilobytes these hops are most of the time, on busy cores nearly all of it, and a worker pinned to one thread would
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
    """Run a coroutine to its end, what it sends to threads included, on this thread.

    Under a running event loop, as in a notebook, it has to be another thread.
    """
    if not _is_loop_running():
        return _run(coroutine)
    with ThreadPoolExecutor(max_workers=1) as pool:
        return pool.submit(_run, coroutine).result()


class _CallingThread(ThreadPoolExecutor):
    """Runs what is submitted at once (asyncio takes no default executor but a thread pool)."""

    def submit(self, function: Callable[..., T], /, *args: Any, **kwargs: Any) -> "Future[T]":
        future: Future[T] = Future()
        try:
            future.set_result(function(*args, **kwargs))
        except BaseException as error:
            future.set_exception(error)
        return future


def _run(coroutine: Coroutine[Any, Any, T]) -> T:
    # loops are kept: making one costs as much as reading a small array
    try:
        loop = _idle.pop()
    except IndexError:
        loop = asyncio.new_event_loop()
        loop.set_default_executor(_CallingThread(max_workers=1))
    try:
        return loop.run_until_complete(coroutine)
    except BaseException:
        # of several chunks one failed: the others must not go on in the next call
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
