"""What a run needs stays in the store while it works and after it finished, whatever other runs do."""

import json
import shutil
import signal
import subprocess
import sys

import pytest

from schemas.configs import PipelineConfig, Variant
from store import open_store
from workflows.datasets import open_dataset
from workflows.evaluate import evaluate
from workflows.runners import SynchronousRunner
from workflows.session import Session

CONFIG = PipelineConfig.model_validate({"sections": {"length": 4, "overlap": 2, "context": 3}})
DIES_AT_WORK = """
import os, signal, sys
from tests.workflows import test_pins as tests

class _Dies:
    def run(self, calls, on_done):
        if calls:
            os.kill(os.getpid(), signal.SIGKILL)

tests.run_squares(sys.argv[1], sys.argv[2], _Dies())
"""


class _Fails(SynchronousRunner):
    def run(self, calls, on_done):
        if calls:
            raise RuntimeError("out of memory")


class _LooksOn(SynchronousRunner):
    """Calls `look` before each batch of work, when the plan is made and pinned."""

    def __init__(self, look):
        self._look = look

    def run(self, calls, on_done):
        if calls:
            self._look()
        super().run(calls, on_done)
