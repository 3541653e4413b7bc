"""Owners of unfinished work: which process it belongs to, and whether that process still runs."""

import os
import platform
import re
import uuid
from functools import cache
from pathlib import Path

from moseg.schemas.digests import digest_bytes

ABANDONED_SECONDS = 86_400.0
"""Age at which unfinished work is a leftover whatever its owner: no put takes a day."""

_OWNED = re.compile(r"(?P<space>[0-9a-f]{16})-(?P<pid>\d+)-[0-9a-f]{32}")


@cache
def process_space() -> str:
    """Return sixteen hexadecimal digits that identify the space in which this process's number is valid.

    They are a digest of the host and, on Linux, of boot and PID namespace: machines of one name may share an object
    store, and two containers of one machine do not see each other's processes.
    """
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_bytes()
        namespace = os.readlink("/proc/self/ns/pid").encode("ascii")
    except OSError:
        boot, namespace = b"", b""
    return digest_bytes("pid-space", platform.node().encode("utf-8"), boot, namespace)[:16]


def is_running(space: str, pid: int) -> bool | None:
    """Return whether a process runs; None if its space is not this process's.

    A number that the system has reused for another process counts as running: leftovers are then only kept longer.
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


def owned_name() -> str:
    """Return a new name for unfinished work, with the process that does it: ``<space>-<pid>-<id>``."""
    return f"{process_space()}-{os.getpid()}-{uuid.uuid4().hex}"


def is_owned_name(name: str) -> bool:
    """Return whether a name has the form that `owned_name` returns."""
    return _OWNED.fullmatch(name) is not None


def is_abandoned(name: str, age: float) -> bool:
    """Return whether work of this name, last changed `age` seconds ago, will never be finished."""
    match = _OWNED.fullmatch(name)
    is_dead = match is not None and is_running(match["space"], int(match["pid"])) is False
    return is_dead or age > ABANDONED_SECONDS
