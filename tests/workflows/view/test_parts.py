"""Parts of the page's server: progress that is observed, edits in words, numbers that are free, sliders."""

import threading

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.corrections import Corrections
from moseg.workflows.config.corrections_file import read_corrections
from moseg.workflows.process.progress import StageProgress, observed_progress
from moseg.workflows.view.edit_words import describe_edit, next_identity, verdicts
from moseg.workflows.view.slider_settings import list_settings
from moseg.workflows.view.worker import Ended, Worker


def test_progress_is_observed_in_its_own_block_alone():
    seen = []

    def note(what, totals, done):
        seen.append((what, dict(totals), dict(done)))

    with observed_progress(note), StageProgress({"flow": 2, "none": 0}, quiet=True) as progress:
        assert list(progress.each("flow", "ab")) == ["a", "b"]
    with StageProgress({"flow": 1}, quiet=True) as progress:
        progress.advance("flow")
    assert seen == [("artifacts", {"flow": 2}, {}), *[("artifacts", {"flow": 2}, {"flow": n}) for n in (1, 2)]]


def test_what_an_observer_raises_ends_the_work():
    def refuse(what, totals, done):
        if done:
            raise Ended

    with observed_progress(refuse), pytest.raises(Ended), StageProgress({"flow": 2}, quiet=True) as progress:
        progress.advance("flow")


def test_a_worker_does_one_thing_after_the_other_and_then_the_last():
    worker, done = Worker(), []
    first = worker.call(done.append, 1)
    failing = worker.call(int, "no number")
    assert first.result() is None
    with pytest.raises(ValueError, match="no number"):
        failing.result()
    worker.close(lambda: done.append("last"))
    assert done == [1, "last"]
    with pytest.raises(Ended):
        worker.check()


def test_spare_work_waits_for_what_was_asked_for():
    worker, done, may_go = Worker(), [], threading.Event()
    worker.call(may_go.wait)
    spare = [worker.spare(done.append, f"spare {number}") for number in (1, 2)]
    asked = worker.call(done.append, "asked")
    may_go.set()
    for future in (asked, *spare):
        future.result()
    worker.close(lambda: None)
    assert done == ["asked", "spare 1", "spare 2"]


def test_every_edit_has_words():
    stroke = {"radius": 2, "points": [[1, 2]]}
    edits = {
        "drop 1": {"drop": 1},
        "keep 2": {"keep": 2},
        "1 is static": {"static": 1},
        "1 moves": {"moving": 1},
        "2 belongs to 1": {"merge": [1, 2]},
        "2, 3 belong to 1": {"merge": [1, 2, 3]},
        "1 is 7 from frame 3 on": {"split": {"object": 1, "frame": 3, "into": 7}},
        "1 is another object from frame 3 on": {"split": {"object": 1, "frame": 3}},
        "1 is called <b>": {"rename": {"object": 1, "name": "<b>"}},
        "paint 9 in frame 3": {"paint": {"object": 9, "frame": 3, "strokes": [stroke]}},
        "erase 1 in frame 3": {"erase": {"object": 1, "frame": 3, "strokes": [stroke]}},
        "erase all in frame 3": {"erase": {"frame": 3, "strokes": [stroke]}},
        "add 8 in frame 3 by region": {"add": {"object": 8, "frame": 3, "points": [[1, 2]]}},
    }
    read = read_corrections(list(edits.values()))
    assert list(map(describe_edit, read.edits)) == list(edits)
    assert next_identity({1, 2}, read) == 10 and next_identity(set(), Corrections()) == 1
    assert verdicts(read) == {1: "moving", 2: "keep"}


def test_sliders_have_the_values_in_force_and_those_of_the_run():
    corrections = Corrections(settings={"clustering.threshold": 0.25})
    listed = {each["name"]: each for each in list_settings(PipelineConfig(), corrections)}
    threshold, motions = listed["clustering.threshold"], listed["clustering.motions"]
    assert (threshold["value"], threshold["initial"], threshold["isChanged"]) == (0.25, 0.5, True)
    assert threshold["min"] < 0.25 < threshold["max"]
    assert (motions["value"], motions["isChanged"]) == ("auto", False) and motions["value"] in motions["options"]
