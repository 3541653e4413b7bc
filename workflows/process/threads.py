"""A fixed number of threads a process: one gives the same bytes on every scheduler, and workers that do not fight for
cores."""

import os
import sys

import cv2
import dask
import threadpoolctl

from moseg.schemas.errors import InputError

MOST_ANYWHERE, MOST_PER_CPU = 64, 4
"""Threads or worker processes that are always taken, and how many for each CPU of this machine."""
THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def thread_environ(count: int) -> dict[str, str]:
    """Environment that binds libraries loaded from now on to `count` threads; raises InputError below 1 or beyond what
    this machine bears."""
    if count < 1:
        raise InputError("not a number of threads", where="--threads", got=count, expected="1 or more")
    check_bearable(count, "threads")
    return dict.fromkeys(THREAD_VARIABLES, str(count))


def check_bearable(count: int, what: str) -> None:
    """Raise InputError where so many `what` ('threads' or 'workers') would bring this machine down."""
    most = max(MOST_ANYWHERE, MOST_PER_CPU * (os.cpu_count() or 1))
    if count > most:
        raise InputError(f"too many {what} for this machine", where=f"--{what}", got=count, expected=f"at most {most}")


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
