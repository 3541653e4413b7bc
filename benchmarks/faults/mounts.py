"""Small and read-only file systems in memory, mounted in a namespace that no other process sees."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_INSIDE = "MOSEG_FAULTS_INSIDE"
ROOMY = "size=256m,nr_inodes=100000"
"""More than any store of these experiments takes."""


def enter_namespace() -> str | None:
    """Restart the script in a mount namespace of its own; if the machine refuses, return the reason."""
    if os.environ.get(_INSIDE):
        return None
    reason = why_no_mounts()
    if reason is None:
        os.environ[_INSIDE] = "1"
        command = [*_namespace(), sys.executable, *sys.argv]
        os.execvp(command[0], command)
    return reason


def why_no_mounts() -> str | None:
    """Return why this machine does not permit mounts; None if it does."""
    probe = "mount -t tmpfs -o size=64k tmpfs /tmp && mount -o remount,ro /tmp"
    try:
        done = subprocess.run([*_namespace(), "sh", "-c", probe], capture_output=True, text=True, check=False)
    except OSError as error:
        return f"cannot run unshare: {error.strerror}"
    return None if done.returncode == 0 else f"cannot mount: {' '.join(done.stderr.split())}"


@contextmanager
def memory_disk(folder: Path, options: str = ROOMY) -> Iterator[Path]:
    """Mount a file system in memory for the block, of the size that `options` of tmpfs set."""
    folder.mkdir(parents=True)
    _call("mount", "-t", "tmpfs", "-o", options, "tmpfs", str(folder))
    try:
        yield folder
    finally:
        _call("umount", "--lazy", str(folder))


def remount(folder: Path, options: str) -> None:
    """Change a file system's size, or whether it is writable (``ro``, ``rw``)."""
    _call("mount", "-o", f"remount,{options}", str(folder))


def _namespace() -> list[str]:
    as_user = [] if os.geteuid() == 0 else ["--user", "--map-root-user"]
    return ["unshare", *as_user, "--mount", "--propagation", "private"]


def _call(*command: str) -> None:
    subprocess.run(command, check=True, capture_output=True)
