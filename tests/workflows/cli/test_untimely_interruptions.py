"""Interruptions at bad moments: in a callback of the garbage collector, and while an object is being made."""

import signal
import subprocess
import sys
from types import SimpleNamespace

import pytest

from moseg.workflows.cli import entry

COLLECTING = """
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

MAKING_A_LOOP = """
import asyncio, os, sys
from asyncio.selector_events import BaseSelectorEventLoop

from moseg.workflows.cli import app, entry

def interrupt(loop):
    os.kill(os.getpid(), int(sys.argv[1]))
    for _ in range(1000):
        pass

def run(arguments):
    # What makes the pipe that the loop's finaliser closes.
    BaseSelectorEventLoop._make_self_pipe = interrupt
    asyncio.new_event_loop()
    return 0

app.run = run
entry.main([])
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals to threads")
@pytest.mark.parametrize("program", [COLLECTING, MAKING_A_LOOP], ids=["collecting", "making-a-loop"])
@pytest.mark.parametrize(
    ("number", "code", "word"), [(signal.SIGTERM, 143, "terminated"), (signal.SIGINT, 130, "interrupted")]
)
def test_an_interruption_at_a_bad_moment_is_one_line(program, number, code, word):
    command = [sys.executable, "-c", program, str(int(number))]
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


def _finaliser_of(name):
    def finalise():
        pass

    finalise.__name__ = name
    return finalise


@pytest.mark.parametrize(
    ("received", "name", "error", "reports"),
    [
        ([signal.SIGTERM], "__del__", AttributeError("_ssock"), 0),
        ([], "__del__", AttributeError("_ssock"), 1),
        ([signal.SIGTERM], "__del__", OSError("disk full"), 1),
        ([signal.SIGTERM], "callback", AttributeError("_ssock"), 1),
    ],
)
def test_only_finalisers_of_what_an_interruption_left_half_made_are_silent(monkeypatch, received, name, error, reports):
    monkeypatch.setattr(entry, "_received", received)
    unraisable, reported = SimpleNamespace(exc_value=error, object=_finaliser_of(name)), []
    entry._handle_unraisable(reported.append, unraisable)
    assert reported == [unraisable] * reports
