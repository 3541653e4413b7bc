"""Commands run as processes of their own, with their time."""

import os
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence

MOSEG = (sys.executable, "-c", "from moseg.workflows.cli import main; main()")

LIST_MODULES = """
import sys
from moseg.workflows.cli.app import run
code = run(sys.argv[2:])
with open(sys.argv[1], "w") as file:
    file.write(" ".join(sys.modules))
sys.exit(code)
"""
"""`moseg` with the arguments after the first, which names the file that gets the names of all modules it loaded."""

IMPORT_MODULES = """
import contextlib, importlib, sys
with open(sys.argv[1]) as file:
    names = file.read().split()
for name in names:
    with contextlib.suppress(ImportError):  # names that packages put into sys.modules without a file of that name
        importlib.import_module(name)
"""
"""The interpreter's start and the modules that such a file names, nothing else."""


def run_timed(command: Sequence[str], environ: Mapping[str, str] | None = None) -> float:
    """Return the wall-clock seconds of a command; raises CalledProcessError, after printing its output, if it fails."""
    start = time.perf_counter()
    done = subprocess.run(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, env={**os.environ, **(environ or {})}, check=False
    )
    wall = time.perf_counter() - start
    if done.returncode:
        print(done.stdout.decode(errors="replace"), file=sys.stderr)
        done.check_returncode()
    return wall
