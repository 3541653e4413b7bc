"""Progress as a person sees it, and ends as a shell sees them: Ctrl-C, a reader that goes, a closed output."""

import json
import re
import subprocess
import sys
import time
from collections import Counter
from pathlib import Path

import pytest

from moseg.store import open_store

pytestmark = pytest.mark.usefixtures("in_empty_folder")

# Computes no affinity before somebody presses a key, however late that is.
WAITS_FOR_THE_KEY = """
import time
from pathlib import Path
from moseg.workflows.engine import execution
from moseg.workflows.cli import main

compute = execution._execute_batch

def wait(store, recipes, log):
    if recipes[0].task == "affinity":
        Path("waits").touch()
        time.sleep(600)
    return compute(store, recipes, log)

execution._execute_batch = wait
main()
"""
# The process that waits for its workers is ended, after some work.
WAITS_FOR_WORKERS = """
from pathlib import Path
from moseg.workflows.cli import main
from moseg.workflows.engine.session import Session

run = Session._run

def touch(self, plan):
    if any(ref.startswith("affinity") for ref in plan.compute):
        Path("waits").touch()
    return run(self, plan)

if __name__ == "__main__":
    Session._run = touch
    main()
"""
HIDE, SHOW = "\x1b[?25l", "\x1b[?25h"
COLOUR = re.compile(r"\x1b\[3[0-9]m|\x1b\[9[0-9]m")


def _bars(text):
    """Lines of bars; what is drawn over itself counts as one line each."""
    lines = [line for part in text.split("\n") for line in re.split(r"\r|\x1b\[\d*[A-K]", part)]
    return [line for line in lines if "━" in line and "/" in line]


def test_bars_fit_the_terminal_and_leave_it_as_it_was(in_terminal, evaluated):
    ran = in_terminal("store", "verify", "--store", evaluated.store, columns=80)
    assert ran.code == 0
    assert ran.raw.count(HIDE) == ran.raw.count(SHOW) == 1
    assert COLOUR.search(ran.raw)
    bars = _bars(ran.text)
    assert {len(line) for line in bars} <= {79, 80}
    assert re.match(r"artifacts: verified ━+ (\d+)/\1 +00:00$", bars[-1])


def test_colours_and_bars_can_be_refused(in_terminal, evaluated):
    verify = ("store", "verify", "--store", evaluated.store)
    plain = in_terminal(*verify, env={"NO_COLOR": "1"})
    assert _bars(plain.text)
    assert not COLOUR.search(plain.raw)
    dumb = in_terminal(*verify, env={"TERM": "dumb"})
    assert "\x1b" not in dumb.raw
    quiet = in_terminal(*verify, "--quiet")
    assert re.fullmatch(r"\d+ artifacts, 0 bad\s+", quiet.raw)
    assert plain.code == dumb.code == quiet.code == 0


def test_each_stage_has_a_bar_by_verbose_alone(in_terminal, evaluated):
    command = [word for word in evaluated.arguments if word != "--quiet"]
    shown = in_terminal(*command, "--verbose")
    assert shown.code == 0
    assert {"flow", "tracks", "score", "artifacts"} <= {line.split()[0] for line in _bars(shown.text)}
    calm = in_terminal(*command, "--store", "another")
    assert calm.code == 0
    bars = _bars(calm.text)
    assert bars and not any(line.startswith(" ") for line in bars)
    refused = in_terminal(*command, "--verbose", "--quiet")
    assert refused.code == 2 and "two opposite options in --verbose" in refused.text


def test_ctrl_c_gives_the_terminal_back_and_the_next_run_goes_on(in_terminal, evaluated, moseg):
    command = [word for word in evaluated.arguments if word != "--quiet"]
    ran = in_terminal(*command, interrupt=lambda text: Path("waits").exists(), program=WAITS_FOR_THE_KEY)
    assert ran.code == 130
    assert ran.raw.count(HIDE) == ran.raw.count(SHOW)
    # The bar is wiped, and the line stands in its place.
    last = re.split(r"\x1b\[\d*[A-K]", ran.text.rstrip())[-1]
    assert last.startswith("moseg: interrupted; what was finished is kept") and "\n" not in last
    assert "Traceback" not in ran.text
    bars = _bars(ran.text)
    assert Counter(map(len, bars)).most_common(1)[0][0] in (79, 80)
    # One bar at a time, which names the stage at work.
    # Some stages are done before they are drawn.
    assert len({found[1] for line in bars if (found := re.match(r"artifacts: (\w+)", line))}) > 1
    assert any(line.endswith(" left") for line in bars)
    assert set(open_store(".moseg/store", create=False).refs())
    again = moseg(*evaluated.arguments)
    assert again.code == 0
    computed, reused = map(int, re.search(r"(\d+) artifacts computed, (\d+) reused", again.out).groups())
    assert reused > 0
    assert computed > 0


@pytest.mark.parametrize("workers", [0, 1])
def test_sigterm_ends_a_run_as_ctrl_c_does(evaluated, moseg, workers):
    words = [sys.executable, "-c", WAITS_FOR_THE_KEY if not workers else WAITS_FOR_WORKERS, *evaluated.arguments]
    words += ["--workers", str(workers)]
    process = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    deadline = time.monotonic() + 600
    while not Path("waits").exists() and process.poll() is None and time.monotonic() < deadline:
        time.sleep(0.02)
    process.terminate()
    out, err = process.communicate(timeout=600)
    assert (process.returncode, out) == (143, ""), err
    assert err.splitlines() == [
        "moseg: terminated; what was finished is kept, the same command goes on from there",
    ]
    assert "interrupted" in moseg("status", "latest").out
    again = moseg(*evaluated.arguments)
    assert again.code == 0
    assert int(re.search(r"(\d+) reused", again.out)[1]) > 0


def test_sigterm_while_workers_start_comes_at_the_end(monkeypatch):
    import signal

    from moseg.workflows.process.interrupts import defer_interrupts

    ends, done = [], []
    previous = signal.signal(signal.SIGTERM, lambda number, frame: ends.append(number))
    try:
        with defer_interrupts():
            signal.raise_signal(signal.SIGTERM)
            assert not ends
            done.append(True)
        assert (ends, done) == ([signal.SIGTERM], [True])
        signal.raise_signal(signal.SIGTERM)
        assert len(ends) == 2
    finally:
        signal.signal(signal.SIGTERM, previous)


def test_ctrl_c_while_the_program_starts_is_one_line(in_terminal, tmp_path):
    # As the import of a library, which takes a third of a second, answers it.
    (tmp_path / "typer.py").write_text("raise KeyboardInterrupt\n")
    ran = in_terminal("backends", env={"PYTHONPATH": str(tmp_path)})
    assert ran.code == 130
    (line,) = ran.text.strip().splitlines()
    assert line.startswith("moseg: interrupted")


def test_a_second_ctrl_c_while_it_ends_shows_no_traces(tmp_path):
    # A thread that will not end, as one that waits for a network: the interpreter's end waits for it, and then the key
    # is pressed again.
    program = (
        "import os, signal, sys, threading, time\n"
        "from moseg.workflows.cli import main\n"
        "import moseg.workflows.cli.app as app\n"
        "def stop(arguments):\n"
        "    threading.Thread(target=outlive).start()\n"
        "    raise KeyboardInterrupt\n"
        "def outlive():\n"
        "    while threading.main_thread().is_alive():\n"
        "        time.sleep(0.01)\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    time.sleep(30)\n"
        "app.run = stop\n"
        "main(['backends'])\n"
    )
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert ran.returncode == -2
    (line,) = ran.stderr.splitlines()
    assert line.startswith("moseg: interrupted")


@pytest.mark.parametrize("command", ["store ls", "store du", "config dump", "--help"])
def test_a_reader_that_goes_is_no_fault(evaluated, command):
    words = [*command.split(), *(["--store", str(evaluated.store)] if command.startswith("store") else [])]
    program = f"from moseg.workflows.cli import main; main({words!r})"
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    process.stdout.close()
    err = process.stderr.read()
    process.stderr.close()
    assert process.wait() == 1
    assert err == ""


def test_a_closed_or_full_output_is_told_in_one_line_or_none(evaluated):
    listing = f"from moseg.workflows.cli import main; main(['store', 'ls', '--store', {str(evaluated.store)!r}])"
    closed = subprocess.run(["sh", "-c", '"$0" -c "$1" >&-', sys.executable, listing], capture_output=True, check=False)
    assert (closed.returncode, closed.stderr) == (0, b"")
    with open("/dev/full", "w") as full:
        ran = subprocess.run([sys.executable, "-c", listing], stdout=full, stderr=subprocess.PIPE, check=False)
    assert ran.returncode == 1
    (line,) = ran.stderr.decode().splitlines()
    assert "No space left" in line


def test_json_on_an_output_that_lacks_characters_is_still_json(in_process, evaluated):
    place = Path("é-🎬")
    place.symlink_to(evaluated.store)
    ref = next(iter(open_store(str(place), create=False).refs("score")))
    shown = in_process("store", "show", ref, "--store", place, "--no-downstream", env={"PYTHONIOENCODING": "ascii"})
    assert shown.returncode == 0, shown.stderr
    assert r"\u00e9-\ud83c\udfac" in shown.stdout
    assert "/é-🎬/" in json.loads(shown.stdout)["place"]


@pytest.mark.parametrize("encoding", ["latin-1", "ascii:strict"])
def test_an_output_that_lacks_the_characters_of_a_name_spells_them(in_process, squares, encoding):
    video = Path("クマ.frames")
    video.symlink_to(squares / "squares" / "frames")
    env = {"PYTHONIOENCODING": encoding}
    options = ("--set", "proposal_source=saliency", "--store", "store")
    segmented = in_process("segment", video, "--out", "クマ", *options, env=env)
    assert segmented.returncode == 0, segmented.stderr
    assert r"\u30af\u30de" in segmented.stdout
    exported = in_process("export", "クマ", "--to", "csv", env=env)
    assert (exported.returncode, exported.stdout.count(r"\u30af\u30de")) == (0, 1)
    status = in_process("status", "latest", "--store", "store", env=env)
    assert (status.returncode, r"\u30af\u30de" in status.stdout) == (0, True)
    refused = in_process("segment", "存在しない.mp4", env=env)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    for command in ((), ("segment",), ("eval",)):
        helped = in_process(*command, "--help", env=env)
        assert (helped.returncode, "Traceback" in helped.stderr) == (0, False)
