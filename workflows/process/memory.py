"""How the C library of a process handles memory that arrays have given back.

By default glibc returns it to the kernel soon, and every flow field then costs a thousand page faults anew: measured at
an eighth of a run's processor time.
"""

import ctypes

MMAP_BYTES = 32 * 2**20
"""Smaller arrays come from the heap; the most that glibc accepts, and several frames."""
TRIM_BYTES = 512 * 2**20
"""Free memory at the heap's end that a process keeps."""

_M_TRIM_THRESHOLD, _M_MMAP_THRESHOLD = -1, -3  # malloc.h


def keep_freed_memory() -> None:
    """Have this process use again what it has freed; nothing changes under another C library."""
    try:
        mallopt = ctypes.CDLL(None).mallopt
    except (AttributeError, OSError, TypeError):
        return
    mallopt(_M_MMAP_THRESHOLD, MMAP_BYTES)
    mallopt(_M_TRIM_THRESHOLD, TRIM_BYTES)


def allocation_environ() -> dict[str, str]:
    """The same for processes to come, as environment."""
    # Tasks run in one thread, which is not the first one: its own arena could not grow to hold what it frees.
    return {
        "MALLOC_MMAP_THRESHOLD_": str(MMAP_BYTES),
        "MALLOC_TRIM_THRESHOLD_": str(TRIM_BYTES),
        "MALLOC_ARENA_MAX": "1",
    }
