"""Each kind of bad input ends with exit code 2 and one clear line on standard error."""

import shutil
from pathlib import Path

import pytest

pytestmark = pytest.mark.usefixtures("in_empty_folder")


def _files(folder):
    return sorted(folder.rglob("*"))


def _assert_bad_input(ran, *words):
    """Check for exit code 2 and one line that names the error."""
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert line.startswith("moseg: ")
    for word in words:
        assert str(word) in line


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ("evaluate", "evaluate"),
        ("eval --datset synthetic", "--datset"),
        ("eval --dataset sintetic", "sintetic"),
        ("eval --sequences panning", "panning"),
        ("eval --variant fuse", "--variant"),
        ("eval --depth monodepth", "depth.method"),
        ("eval --proposals folder", "--proposals"),
        ("eval --proposals folder:nowhere", "nowhere"),
        ("eval --dataset davis16", "$MOSEG_DATA"),
        ("eval --dataset davis16 --root nowhere", "nowhere"),
        ("eval --root .", "no files"),
        ("eval --set proposal_source=folder", "--proposals folder:PATH"),
        ("eval --set depth.method=folder", "--depth folder:PATH"),
        ("eval --proposals folder:. --set proposal_source=saliency", "--proposals folder:PATH"),
        ("eval --set nonsense", "nonsense"),
        ("eval --set nostage.gap=3", "nostage"),
        ("eval --set fundamental.gap=three", "'three'"),
        ("eval --workers 2 --scheduler tcp://127.0.0.1:8786", "--scheduler"),
        ("eval --scheduler nowhere", "--scheduler"),
        ("eval --store ftp://host/store", "ftp://"),
        ("plan --variant all", "--variant"),
        ("ablate --dataset sintetic", "sintetic"),
        ("segment", "VIDEO"),
        ("segment nowhere.mp4", "nowhere.mp4"),
        ("segment . --motions gt", "--motions"),
        ("segment . --set clustering.motions=gt", "no ground truth of your own video"),
        ("segment . --flow groundtruth", "no ground truth of your own video in flow.method"),
        ("segment . --set proposal_source=groundtruth", "no ground truth of your own video in proposal_source"),
        ("segment .", "no images"),
        ("score", "predictions"),
        ("score --predictions nowhere", "nowhere"),
        ("store", "command"),
        ("store ls", ".moseg/store"),
        ("store gc --grace-hours -1", "--grace-hours"),
        ("store gc --older 7x", "expected a number with s, m, h, d or w"),
    ],
)
def test_bad_use_is_one_line_before_any_work(moseg, arguments, word):
    _assert_bad_input(moseg(*arguments.split()), word)
    assert not list(Path(".moseg").rglob("objects"))


@pytest.fixture
def frames(squares, tmp_path):
    """Return the folder of a copy of the squares' frames, for a test to damage."""
    return Path(shutil.copytree(squares / "squares" / "frames", tmp_path / "spoilt" / "frames"))


@pytest.fixture
def evaluate_spoilt(moseg, frames, squares):
    """Return a function that evaluates the damaged copy, after adding masks if there are none."""

    def call():
        masks = frames.parent / "masks"
        if not masks.exists():
            shutil.copytree(squares / "squares" / "masks", masks)
        return moseg("eval", "--dataset", "folder", "--root", frames.parents[0], "--quiet")

    return call


def test_an_empty_video_argument_is_not_the_working_folder(moseg, frames, monkeypatch):
    monkeypatch.chdir(frames)
    _assert_bad_input(moseg("segment", ""), "no video named")


@pytest.mark.parametrize("num_frames", [0, 1])
def test_too_few_frames(moseg, frames, num_frames):
    for path in sorted(frames.iterdir())[num_frames:]:
        path.unlink()
    _assert_bad_input(moseg("segment", frames, "--quiet"))
    assert not Path("out", "motion.json").exists()


def test_one_frame_with_ground_truth(evaluate_spoilt, frames, squares):
    shutil.rmtree(frames)
    frames.mkdir()
    (frames.parent / "masks").mkdir()
    for folder in ("frames", "masks"):
        shutil.copy(squares / "squares" / folder / "00000.png", frames.parent / folder)
    _assert_bad_input(evaluate_spoilt(), "at least 2")


def test_ground_truth_that_is_missing(evaluate_spoilt, frames):
    (frames.parent / "masks").mkdir()
    _assert_bad_input(evaluate_spoilt(), frames.parent / "masks")


def test_a_sequence_without_ground_truth_cannot_be_scored(moseg, frames):
    ran = moseg("eval", "--dataset", "folder", "--root", frames.parents[0], "--quiet")
    _assert_bad_input(ran, "ground truth")


@pytest.mark.parametrize("command", ["eval", "ablate"])
def test_json_that_cannot_be_written_is_reported_before_the_work(moseg, squares, tmp_path, command):
    (tmp_path / "file").touch()
    for target in (tmp_path / "file" / "report.json", tmp_path, tmp_path / ("x" * 300)):
        ran = moseg(command, "--dataset", "folder", "--root", squares, "--json", target)
        _assert_bad_input(ran)
    assert not Path(".moseg").exists()


@pytest.mark.parametrize(
    "arguments",
    [
        ("eval", "--dataset", "synthetic", "--report", "LONG.html"),
        ("score", "--dataset", "synthetic", "--predictions", "LONG"),
        ("score", "--dataset", "synthetic", "--predictions", ".", "--json", "LONG"),
        ("config", "dump", "--out", "LONG"),
    ],
)
def test_a_name_that_is_too_long_is_one_line(moseg, arguments):
    name = "x" * 300
    _assert_bad_input(moseg(*(argument.replace("LONG", name) for argument in arguments)), name)


@pytest.mark.parametrize("page", ["both", "./both", "link"])
def test_scores_and_page_are_two_files(moseg, squares, tmp_path, monkeypatch, page):
    monkeypatch.chdir(tmp_path)
    Path("link").symlink_to("both")
    ran = moseg("eval", "--dataset", "folder", "--root", squares, "--json", "both", "--report", page)
    _assert_bad_input(ran, "scores and page in one file in --report")
    assert not Path("both").exists()


def test_a_path_that_is_no_store(moseg, squares, tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "thesis.tex").touch()
    for store in (tmp_path / "file", tmp_path / "folder"):
        before = _files(tmp_path)
        for command in ("eval", "plan"):
            _assert_bad_input(moseg(command, "--dataset", "folder", "--root", squares, "--store", store), store)
        assert _files(tmp_path) == before


def test_an_unknown_or_ambiguous_key(evaluated, moseg):
    _assert_bad_input(moseg("store", "show", "flow/zz", "--store", evaluated.store), "flow/zz")
    _assert_bad_input(moseg("store", "show", "flow/", "--store", evaluated.store), "18")
