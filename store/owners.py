"""Which process something half done belongs to, and whether that process still runs."""

import os
import platform
import re
import uuid
from functools import cache
from pathlib import Path

from moseg.schemas.digests import digest_bytes

ABANDONED_SECONDS = 86_400.0
"""Age at which something half done is a leftover whoever owns it: no put takes a day."""

_OWNED = re.compile(r"(?P<space>[0-9a-f]{16})-(?P<pid>\d+)-[0-9a-f]{32}")


@cache
def process_space() -> str:
    """Sixteen hexadecimal digits that name the space in which this process's number means something.

    Host and, on Linux, boot and PID namespace: machines of one name may share an object store, and two containers of
    one machine do not see each other's processes.
    """
    try:
        boot = Path("/proc/sys/kernel/random/boot_id").read_bytes()
        namespace = os.readlink("/proc/self/ns/pid").encode("ascii")
    except OSError:
        boot, namespace = b"", b""
    return digest_bytes("pid-space", platform.node().encode("utf-8"), boot, namespace)[:16]


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


def owned_name() -> str:
    """A new name for something half done, which says which process makes it: ``<space>-<pid>-<id>``."""
    return f"{process_space()}-{os.getpid()}-{uuid.uuid4().hex}"


def is_owned_name(name: str) -> bool:
    """Whether a name is such as `owned_name` gives."""
    return _OWNED.fullmatch(name) is not None


def is_abandoned(name: str, age: float) -> bool:
    """Whether what bears this name, last changed `age` seconds ago, will never be finished."""
    match = _OWNED.fullmatch(name)
    is_dead = match is not None and is_running(match["space"], int(match["pid"])) is False
    return is_dead or age > ABANDONED_SECONDS
