"""Coroutines on the calling thread."""

import asyncio
import threading

import pytest

from moseg.store.inline_loop import run_inline


async def thread_of_work() -> threading.Thread:
    return await asyncio.to_thread(threading.current_thread)


def test_work_for_threads_runs_on_the_calling_thread():
    assert run_inline(thread_of_work()) is threading.current_thread()


def test_a_running_loop_is_not_used():
    async def notebook():
        return run_inline(thread_of_work())

    assert asyncio.run(notebook()) is not threading.current_thread()


def test_calls_can_nest_through_work():
    async def outer() -> int:
        return await asyncio.to_thread(lambda: run_inline(inner()))

    async def inner() -> int:
        return 7

    assert run_inline(outer()) == 7


def test_siblings_of_a_failed_task_are_cancelled():
    finished = []

    async def fail() -> None:
        raise ValueError("chunk 0")

    async def go_on(number: int) -> None:
        for _ in range(5):
            await asyncio.sleep(0)
        finished.append(number)

    async def gather() -> None:
        await asyncio.gather(fail(), *(go_on(number) for number in range(3)))

    with pytest.raises(ValueError, match="chunk 0"):
        run_inline(gather())
    run_inline(go_on(9))
    assert finished == [9]
