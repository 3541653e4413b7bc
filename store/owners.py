"""Which process a staging folder or a pin belongs to, and whether that process still runs."""

import os
import platform
from functools import cache

from schemas.digests import digest_bytes


@cache
def process_space() -> str:
    """Sixteen hexadecimal digits that name the space in which this process's number means something.

    Host and, on Linux, PID namespace: two containers with one host name do not see each other's processes.
    """
    try:
        namespace = os.readlink("/proc/self/ns/pid")
    except OSError:
        namespace = ""
    return digest_bytes("pid-space", platform.node().encode("utf-8"), namespace.encode("ascii"))[:16]


def is_running(space: str, pid: int) -> bool | None:
    """Whether a process runs; None where it lives in a space that cannot be asked from here.

    A number that the system has given to another process counts as running: leftovers are then only kept longer.
    """
    if space != process_space():
        return None
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
