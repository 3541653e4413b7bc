"""Progress without a terminal: few plain lines, or none."""

import time

import pytest

from moseg.workflows.process import progress
from moseg.workflows.process.progress import StageProgress, Waiting


@pytest.fixture
def clock(monkeypatch):
    """A clock that tests move."""
    now = [1000.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


def test_the_first_line_comes_soon_and_others_seldom(clock, capsys):
    with StageProgress({"flow": 100, "tracks": 100, "none": 0}) as shown:
        for _ in range(100):
            clock[0] += 1.0
            shown.advance("flow")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "2/200 artifacts in 2 s, about 198 s left (flow 2/100, tracks 0/100)"
    assert len(lines) == 1 + 6 + 1
    assert lines[-1] == "100/200 artifacts in 100 s, about 100 s left (flow 100/100, tracks 0/100)"


def test_quiet_is_silent(clock, capsys):
    with StageProgress({"flow": 3}, quiet=True) as shown:
        for _ in range(3):
            clock[0] += 60
            shown.advance("flow")
    with Waiting("counting", quiet=True):
        pass
    assert capsys.readouterr() == ("", "")


def test_work_that_is_usually_short_shows_no_early_line(clock, capsys):
    with StageProgress({"files": 3}, what="files hashed", patience_sec=1.0) as shown:
        for _ in range(3):
            shown.advance("files")
    assert capsys.readouterr().err == ""
    with StageProgress({"files": 3}, what="files hashed", patience_sec=1.0) as shown:
        for _ in shown.each("files", range(3)):
            clock[0] += 2.0
    assert capsys.readouterr().err.splitlines() == [
        "1/3 files hashed in 2 s, about 4 s left (files 1/3)",
        "3/3 files hashed in 6 s (files 3/3)",
    ]


def test_an_interruption_prints_no_last_line(clock, capsys):
    def work():
        with StageProgress({"flow": 3}) as shown:
            shown.advance("flow")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work()
    assert capsys.readouterr().err == ""


def test_waiting_is_shown_after_some_time(monkeypatch, capsys):
    monkeypatch.setattr(progress, "PATIENCE_SEC", 0.01)
    shown, deadline = "", time.monotonic() + 600
    with Waiting("adding up the store"):
        while not shown and time.monotonic() < deadline:
            time.sleep(0.005)
            shown = capsys.readouterr().err
    assert shown + capsys.readouterr().err == "adding up the store …\n"
    monkeypatch.setattr(progress, "PATIENCE_SEC", 600)
    with Waiting("adding up the store"):
        pass
    assert capsys.readouterr().err == ""
