"""Threads and memory of a process.

Its libraries are bound to a fixed number of threads: one thread gives the same bytes on every scheduler, and workers do
not compete for cores. The C library keeps the memory that arrays have freed: by default glibc returns it to the kernel
soon, and every flow field then costs a thousand new page faults, an eighth of a run's processor time as measured.
"""

import ctypes
import os
import sys

import cv2
import dask
import threadpoolctl

from moseg.schemas.errors import InputError

MAX_ANYWHERE, MAX_PER_CPU = 64, 4
"""Threads or worker processes that are always accepted, and how many for each CPU of this machine."""
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")

MMAP_BYTES = 32 * 2**20
"""Smaller arrays come from the heap; the largest value that glibc accepts, and several frames."""
TRIM_BYTES = 512 * 2**20
"""Free memory at the heap's end that a process keeps."""

_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # malloc.h


def pin_threads(count: int = 1) -> None:
    """Bind OpenCV's pool, the BLAS libraries, OpenMP and torch of this process to `count` threads each.

    With more than one, sums may be taken in another order and results differ in their last digits.
    """
    os.environ.update(thread_environ(count))
    # OMP_NUM_THREADS does not bind OpenCV's own pool.
    cv2.setNumThreads(count)
    threadpoolctl.threadpool_limits(count)
    # A torch that is loaded later reads the environment.
    if "torch" in sys.modules:
        sys.modules["torch"].set_num_threads(count)
    dask.config.set(scheduler="synchronous")


def thread_environ(count: int) -> dict[str, str]:
    """Return the environment that binds libraries loaded from now on to `count` threads; raise InputError if it is
    below 1 or too large for this machine."""
    if count < 1:
        raise InputError("not a number of threads", where="--threads", got=count, expected="1 or more")
    check_bearable(count, "threads")
    return dict.fromkeys(THREAD_VARIABLES, str(count))


def check_bearable(count: int, what: str) -> None:
    """Raise InputError if so many `what` ('threads' or 'workers') would exhaust this machine."""
    limit = max(MAX_ANYWHERE, MAX_PER_CPU * (os.cpu_count() or 1))
    if count > limit:
        raise InputError(f"too many {what} for this machine", where=f"--{what}", got=count, expected=f"at most {limit}")


def keep_freed_memory() -> None:
    """Have this process reuse the memory that it has freed; under another C library than glibc do nothing."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):
        return
    mallopt(_M_MMAP_THRESHOLD, MMAP_BYTES)
    mallopt(_M_TRIM_THRESHOLD, TRIM_BYTES)


def allocation_environ() -> dict[str, str]:
    """Return the environment that has the same effect in processes started with it."""
    # Tasks run in one thread, which is not the first one: its own arena could not grow to hold what it frees.
    return {
        "MALLOC_MMAP_THRESHOLD_": str(MMAP_BYTES),
        "MALLOC_TRIM_THRESHOLD_": str(TRIM_BYTES),
        "MALLOC_ARENA_MAX": "1",
    }
