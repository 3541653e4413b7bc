"""A process reuses the memory that arrays have freed."""

import os
import platform
import subprocess
import sys

import pytest

from moseg.workflows.process.resources import allocation_environ

ALLOCATE = """
import ctypes, resource, sys
from moseg.workflows.process.resources import keep_freed_memory
if "keep" in sys.argv:
    keep_freed_memory()
malloc, free, memset = (getattr(ctypes.CDLL(None), name) for name in ("malloc", "free", "memset"))
malloc.restype, malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
free.argtypes, memset.argtypes = [ctypes.c_void_p], [ctypes.c_void_p, ctypes.c_int, ctypes.c_size_t]
for _ in range(100):
    blocks = [malloc(3_300_000) for _ in range(4)]
    for block in blocks:
        memset(block, 1, 3_300_000)
    for block in blocks:
        free(block)
print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt)
"""


def _faults(*arguments, environ=None):
    # Dask leaves the environment of its workers in the process that started them, which may be this one.
    plain = {name: value for name, value in os.environ.items() if name not in allocation_environ()}
    command = [sys.executable, "-c", ALLOCATE, *arguments]
    ran = subprocess.run(command, env=plain | (environ or {}), capture_output=True, text=True, check=True)
    return int(ran.stdout)


@pytest.mark.skipif(platform.libc_ver()[0] != "glibc", reason="glibc's setting")
def test_memory_of_flow_fields_is_reused():
    assert _faults("keep") < _faults() / 2
    assert _faults(environ=allocation_environ()) < _faults() / 2
