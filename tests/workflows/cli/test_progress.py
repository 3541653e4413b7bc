"""Progress without a terminal: few plain lines, or none."""

import re
import sys
import time
from types import ModuleType, SimpleNamespace

import pytest

from moseg.workflows.process import progress
from moseg.workflows.process.progress import StageProgress, Waiting, show_details


@pytest.fixture
def clock(monkeypatch):
    """A clock that tests move."""
    now = [1000.0]
    monkeypatch.setattr(progress.time, "monotonic", lambda: now[0])
    return now


@pytest.fixture
def in_detail():
    """Show progress as ``--verbose`` does."""
    show_details(True)
    yield
    show_details(False)


@pytest.fixture
def notebook(monkeypatch):
    """Return what a notebook displays: a list of the contents of each place."""
    places = []

    class Handle:
        def __init__(self, content):
            places.append([content._repr_html_()])
            self.place = places[-1]

        def update(self, content):
            self.place.append(content._repr_html_())

    shell = SimpleNamespace(kernel=object())
    module = ModuleType("IPython")
    module.get_ipython = lambda: shell
    inner = ModuleType("IPython.display")
    inner.display = lambda content, display_id: Handle(content)
    monkeypatch.setitem(sys.modules, "IPython", module)
    monkeypatch.setitem(sys.modules, "IPython.display", inner)
    return places


def test_a_log_gets_a_line_a_stage_at_most(clock, capsys):
    totals = {"flow": 100, "saliency": 50, "labels": 1, "score": 1}
    with StageProgress(totals) as shown:
        for _ in range(100):
            clock[0] += 1.0
            shown.advance("flow")
        for _ in range(50):
            clock[0] += 1.0
            shown.advance("saliency")
        # Both at once: the line at the end says so.
        shown.advance("labels")
        shown.advance("score")
    assert capsys.readouterr().err.splitlines() == [
        "100/152 artifacts in 100 s, about 52 s left (flow done)",
        "150/152 artifacts in 150 s, about 2 s left (saliency done)",
        "152/152 artifacts in 150 s",
    ]


def test_short_work_leaves_no_line_in_a_log(clock, capsys):
    with StageProgress({"flow": 3, "tracks": 3}) as shown:
        for stage in ("flow", "tracks") * 3:
            clock[0] += 0.3
            shown.advance(stage)
    assert capsys.readouterr().err == ""


def test_in_detail_the_first_line_comes_soon_and_others_seldom(clock, capsys, in_detail):
    with StageProgress({"flow": 100, "tracks": 100, "none": 0}) as shown:
        for _ in range(100):
            clock[0] += 1.0
            shown.advance("flow")
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "2/200 artifacts in 2 s, about 198 s left (flow 2/100, tracks 0/100)"
    assert len(lines) == 1 + 6 + 1
    assert lines[-1] == "100/200 artifacts in 100 s, about 100 s left (flow 100/100, tracks 0/100)"


def test_a_notebook_has_one_bar_that_goes(clock, capsys, notebook):
    with StageProgress({"flow": 100, "motion_network": 100}) as shown:
        for stage in ("flow", "motion_network"):
            for _ in range(100):
                clock[0] += 0.1
                shown.advance(stage)
    (place,) = notebook
    assert all("<progress" in content for content in place[:-1]) and place[-1] == ""
    assert "artifacts: flow " in place[0] and "0/200" in place[0]
    assert "artifacts: motion network " in place[-2] and 'max="200"' in place[-2]
    assert re.search(r'value="1\d\d".* 1\d\d/200, about \d s left', place[-6])
    # Not a message for each artifact.
    assert 40 < len(place) < 110
    assert capsys.readouterr() == ("", "")


def test_a_notebook_keeps_the_bar_of_what_failed(clock, notebook):
    def work():
        with StageProgress({"flow": 3}) as shown:
            clock[0] += 1.0
            shown.advance("flow")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work()
    assert "1/3" in notebook[0][-1]


def test_a_notebook_is_quiet_if_asked(notebook):
    with StageProgress({"flow": 3}, quiet=True) as shown:
        shown.advance("flow", 3)
    assert not notebook


def test_a_shell_on_a_terminal_is_no_notebook(clock, notebook, capsys):
    sys.modules["IPython"].get_ipython().kernel = None
    with StageProgress({"flow": 1}) as shown:
        clock[0] += 5.0
        shown.advance("flow")
    assert not notebook
    assert capsys.readouterr().err == "1/1 artifacts in 5 s\n"


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
    assert capsys.readouterr().err.splitlines() == ["3/3 files hashed in 6 s"]


def test_an_interruption_prints_no_last_line(clock, capsys):
    def work():
        with StageProgress({"flow": 3}) as shown:
            clock[0] += 60.0
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
