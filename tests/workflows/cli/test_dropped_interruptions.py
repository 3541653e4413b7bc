"""Interruptions that Python drops, because they arrive in a callback of the garbage collector."""

import signal
import subprocess
import sys

import pytest

PROGRAM = """
import gc, os, signal, sys, time

from moseg.workflows.cli import app, entry

def interrupt(phase, info):
    gc.callbacks.remove(interrupt)
    os.kill(os.getpid(), int(sys.argv[1]))
    # The handler of the signal raises here, and the collector drops what its callbacks raise.
    for _ in range(1000):
        pass

def run(arguments):
    gc.callbacks.append(interrupt)
    gc.collect()
    time.sleep(600)
    return 0

app.run = run
entry.main([])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals to threads")
@pytest.mark.parametrize(
    ("number", "code", "word"), [(signal.SIGTERM, 143, "terminated"), (signal.SIGINT, 130, "interrupted")]
)
def test_an_interruption_that_python_drops_is_repeated(number, code, word):
    command = [sys.executable, "-c", PROGRAM, str(int(number))]
    # Processes that a shell runs in the background ignore Ctrl-C.
    ran = subprocess.run(
        command,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    assert (ran.returncode, ran.stdout) == (code, "")
    assert ran.stderr == f"moseg: {word}; what was finished is kept, the same command goes on from there\n"
