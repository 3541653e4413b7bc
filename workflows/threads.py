"""One thread a process: the same bytes on every scheduler, and workers that do not fight for cores."""

import os

import cv2
import dask
import threadpoolctl

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")


def pin_threads() -> None:
    """Bind OpenCV's pool, the BLAS libraries and OpenMP of this process to one thread each."""
    for name in THREAD_VARIABLES:
        os.environ[name] = "1"
    # OMP_NUM_THREADS does not bind OpenCV's own pool.
    cv2.setNumThreads(1)
    threadpoolctl.threadpool_limits(1)
    dask.config.set(scheduler="synchronous")
