"""Other runs and other programs meanwhile: results of one video are never those of another, and no edit is lost."""

import pytest

from moseg.schemas.corrections import Corrections
from moseg.schemas.errors import InputError
from moseg.workflows.config.corrections_file import read_corrections
from moseg.workflows.view.correction_history import CorrectionHistory

OPTIONS = ("--section-length", "4", "--set", "sections.overlap=2", "--quiet")
FILE = "corrections.yaml"


def _edit(server, edit):
    return server.ask("POST", "edits", {"revision": server.state()["revision"], "edit": edit})


def _objects(server):
    return [each["identity"] for each in server.state()["result"]["objects"]]


@pytest.fixture
def segment(moseg, tmp_path):
    """Return a function that segments a video into a folder of its own, with one store for all."""

    def call(video, name, *options):
        files = ("--out", tmp_path / name, "--store", tmp_path / "store")
        assert moseg("segment", video, *files, *OPTIONS, *options).code == 0
        return tmp_path / name

    return call


def test_a_later_run_of_another_video_of_the_same_name_is_not_opened(
    segment, segmented, write_squares, serve, tmp_path
):
    other = write_squares(tmp_path / "other", seed=1) / "frames"
    out = segment(segmented.frames, "one", "--drop", "2")
    first = serve(out, "--store", tmp_path / "store", "--quiet")
    expected = first.wait("ready")["result"]["source"]
    segment(other, "two")
    server = serve(out, "--store", tmp_path / "store", "--quiet")
    assert server.wait("ready")["result"]["source"] == expected
    latest = serve("latest", "--out", out, "--store", tmp_path / "store", "--quiet")
    assert "corrections of another video" in latest.wait("failed")["message"]
    assert read_corrections(str(out / FILE)).video is not None


def test_a_run_with_corrections_is_opened_without_them(segment, segmented, serve, tmp_path):
    edits = "  - split: {object: 2, frame: 5, into: 7}\n"
    (tmp_path / "more.yaml").write_text(f"version: 1\nsettings: {{clustering.motions: 2}}\nedits:\n{edits}")
    out = segment(segmented.frames, "one", "--split", "2@5:7")
    segment(segmented.frames, "one", "--corrections", tmp_path / "more.yaml")
    server = serve(out, "--store", tmp_path / "store", "--quiet")
    (motions,) = [each for each in server.wait("ready")["result"]["settings"] if each["name"] == "clustering.motions"]
    assert (motions["initial"], motions["value"]) == ("auto", 2)
    while server.state()["result"]["corrections"]["canUndo"]:
        assert server.ask("POST", "undo", {"revision": server.state()["revision"]}).status == 200
    assert _objects(server) == [1, 2]
    assert "--split" not in server.state()["result"]["command"]


def test_an_edit_by_another_program_is_seen_and_one_that_cannot_apply_changes_nothing(serve_video, result):
    server = serve_video()
    assert _edit(server, {"drop": 2}).status == 200
    before = (result.out / FILE).read_text()
    (result.out / FILE).write_text(before + "  - drop: 99\n")
    for _ in range(2):
        refused = server.ask("POST", "export", {"revision": server.state()["revision"], "formats": []})
        assert (refused.status, "no such object" in refused.json()["message"]) == (400, True)
    assert _objects(server) == [1]
    (result.out / FILE).write_text(before + "  - keep: 2\n")
    assert _edit(server, {"rename": {"object": 1, "name": "a"}}).status == 409
    assert _edit(server, {"rename": {"object": 1, "name": "a"}}).status == 200
    assert len(read_corrections(str(result.out / FILE)).edits) == 3


def test_corrections_that_cannot_be_enforced_leave_the_history_as_it_is(tmp_path):
    history = CorrectionHistory(tmp_path)
    history.put(history.with_edit({"drop": 2}))
    history.path.write_text(history.path.read_text() + "  - drop: 3\n")

    def enforce(corrections: Corrections):
        raise InputError(f"{len(corrections.edits)} edits")

    with pytest.raises(InputError, match="2 edits"):
        history.reload(enforce)
    assert len(history.current.edits) == 1 and history.is_stale()


@pytest.mark.parametrize(
    ("options", "name"),
    [
        (("--start", "3"), "--start, --end or --every"),
        (("--fps", "5"), "--fps"),
        (("--variant", "base"), "--variant"),
        (("--set", "clustering.motions=1"), "an option of the pipeline"),
    ],
)
def test_options_that_a_finished_result_would_not_follow_are_refused(moseg, result, options, name):
    for what in (result.out, "latest"):
        ran = moseg("view", what, "--out", result.out, "--store", result.store, "--no-browser", *options)
        assert (ran.code, ran.err.count("\n")) == (2, 1)
        assert f"an option without effect on a finished result in {what}; got {name}" in ran.err
