"""Settings of the process that a run changes, restored for the caller."""

import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from threading import Lock

import cv2
import dask
import threadpoolctl

from moseg.workflows.process import devices
from moseg.workflows.process.resources import THREAD_VARIABLES, allocation_environ


class _Calls:
    """Calls under way in this process, and what restores its settings after the last of them."""

    def __init__(self):
        self.lock = Lock()
        self.number = 0
        self.settings = ExitStack()


_CALLS = _Calls()


@contextmanager
def kept_process_settings() -> Iterator[None]:
    """Restore threads, device and Dask's scheduler at the end of the block.

    Where blocks overlap in several threads, the first keeps the settings and the last to end restores them. A command
    ends with its process; a notebook goes on, and its own arrays and networks need their threads again. What the block
    itself loads first keeps the number of threads that it was loaded with.
    """
    with _CALLS.lock:
        if not _CALLS.number:
            _keep_settings(_CALLS.settings)
        _CALLS.number += 1
    try:
        yield
    finally:
        with _CALLS.lock:
            _CALLS.number -= 1
            if not _CALLS.number:
                _CALLS.settings.close()


def _keep_settings(stack: ExitStack) -> None:
    """Register what restores the settings of now when the stack closes."""
    if torch := sys.modules.get("torch"):
        stack.callback(torch.set_num_threads, torch.get_num_threads())
    stack.callback(devices.set_device, devices.chosen_device())
    stack.callback(cv2.setNumThreads, cv2.getNumThreads())
    # Dask leaves what it starts workers with in this process too.
    names = (*THREAD_VARIABLES, *allocation_environ())
    stack.callback(_restore_environ, {name: os.environ.get(name) for name in names})
    stack.enter_context(dask.config.set(scheduler=dask.config.get("scheduler", None)))
    stack.enter_context(threadpoolctl.threadpool_limits(None))


def _restore_environ(environ: Mapping[str, str | None]) -> None:
    for name, value in environ.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value
