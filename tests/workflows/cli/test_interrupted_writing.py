"""Ctrl-C while results are written: no half file is left, and the same command then writes them whole."""

import json
import re

import pytest
from PIL import Image

from moseg.workflows.exports import saved_segmentation
from moseg.workflows.pipelines.segment import StoredSegmentation

pytestmark = pytest.mark.usefixtures("in_empty_folder")


@pytest.fixture
def arguments(squares):
    folder = squares / "squares"
    return ("segment", folder / "frames", "--proposals", f"folder:{folder / 'masks'}", "--variant", "base", "--quiet")


def _contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def _interrupt_pass(monkeypatch, number):
    """Ctrl-C comes in the middle of the labels' pass of this number."""
    labels, passes = StoredSegmentation.labels, []

    def interrupted(self, *arguments):
        passes.append(self)
        index = len(passes)
        for count, mask in enumerate(labels(self, *arguments)):
            if index == number and count == 4:
                raise KeyboardInterrupt
            yield mask

    monkeypatch.setattr(StoredSegmentation, "labels", interrupted)


@pytest.mark.parametrize("number", [1, 2, 3], ids=["masks", "overlay", "summary"])
def test_a_segmentation_is_written_whole_by_the_next_run(moseg, arguments, monkeypatch, tmp_path, number):
    out = tmp_path / "out"
    with monkeypatch.context() as patched:
        _interrupt_pass(patched, number)
        ran = moseg(*arguments, "--out", out)
    assert ran.code == 130
    (line,) = ran.err.splitlines()
    assert line.startswith("moseg: interrupted")
    left = _contents(out)
    # Under its own name each file is whole.
    for path in left:
        assert path.suffix in (".png", ".mp4"), path
        if path.suffix == ".png":
            Image.open(out / path).load()
    again = moseg(*arguments, "--out", out)
    assert (again.code, again.err) == (0, "")
    assert re.search(r"\(0 artifacts computed", again.out)
    whole = _contents(out)
    assert len([path for path in whole if path.suffix == ".png"]) == 10
    assert json.loads((out / "motion.json").read_text())
    assert all(whole[path] == content for path, content in left.items())


def test_an_interrupted_export_leaves_what_was_there(moseg, arguments, monkeypatch, tmp_path):
    out = tmp_path / "out"
    assert moseg(*arguments, "--out", out).code == 0
    export = ("export", out, "--to", "npz", "--to", "coco")
    assert moseg(*export).code == 0
    before = _contents(out)
    with monkeypatch.context() as patched:
        read, counts = saved_segmentation.SavedSegmentation.labels, []

        def interrupted(self, *arguments):
            for mask in read(self, *arguments):
                counts.append(mask)
                if len(counts) == 5:
                    raise KeyboardInterrupt
                yield mask

        patched.setattr(saved_segmentation.SavedSegmentation, "labels", interrupted)
        assert moseg(*export).code == 130
    assert _contents(out) == before
    assert moseg(*export).code == 0
    assert _contents(out) == before


def test_an_interrupted_report_leaves_the_one_before(moseg, evaluated, monkeypatch, tmp_path):
    page = tmp_path / "report.html"
    page.write_text("<!doctype html>the one before")
    report = ("report", "latest", "--store", evaluated.store, "--out", page, "--quiet")

    def interrupt(*arguments, **options):
        raise KeyboardInterrupt

    for broken in ("moseg.workflows.reports.from_log.build_page", "moseg.workflows.reports.run_report.render_page"):
        with monkeypatch.context() as patched:
            patched.setattr(broken, interrupt)
            ran = moseg(*report)
        assert ran.code == 130
        assert len(ran.err.splitlines()) == 1
        assert page.read_text() == "<!doctype html>the one before"
        assert list(tmp_path.glob("*report*")) == [page]
    assert moseg(*report).code == 0
    assert page.read_text().startswith("<!")
