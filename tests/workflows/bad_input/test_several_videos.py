"""Several videos in one call, what stands for them, and the folders of their results."""

import io
import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest


@pytest.fixture
def clips(write_video, write_folder, frames, tmp_path):
    """Return a folder of two videos and a folder of frames, of different content, and other files."""
    write_video("clips/one.mp4")
    write_video("clips/two.mp4", [image[:, ::-1] for image in frames])
    write_folder("clips/three", [image[::-1] for image in frames])
    (tmp_path / "clips" / "notes.txt").write_text("not a video")
    return tmp_path / "clips"


@pytest.fixture
def segment_all(moseg, store, tmp_path, in_empty_folder):
    """Run `moseg segment` on several words; return how it ended."""

    def call(*words, options=()):
        quick = ("--quality", "fast", "--quiet", "--store", store, "--set", "max_side=32")
        return moseg("segment", *quick, "--out", tmp_path / "out", *options, "--", *words)

    return call


def _results(printed):
    """Return the lines of results; each may be followed by one that says where to look."""
    return [line for line in printed.splitlines() if not line.startswith("look at: ")]


def _summaries(out):
    return {path.parent.name: json.loads(path.read_text()) for path in out.rglob("motion.json")}


def test_each_of_several_videos_has_a_folder_of_its_name(segment_all, clips, tmp_path):
    ran = segment_all(clips / "one.mp4", clips / "two.mp4", clips / "three")
    assert (ran.code, ran.err) == (0, "")
    assert len(_results(ran.out)) == 3
    summaries = _summaries(tmp_path / "out")
    assert {name: summary["name"] for name, summary in summaries.items()} == {n: n for n in ("one", "two", "three")}
    assert len({summary["video"] for summary in summaries.values()}) == 3
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["one", "three", "two"]
    assert len(list((tmp_path / "out" / "three" / "masks").iterdir())) == 5


def test_folders_of_frames_keep_what_follows_a_dot_in_their_names(segment_all, write_folder, frames, tmp_path):
    write_folder("take.1", frames)
    write_folder("take.2", [image[::-1] for image in frames])
    ran = segment_all(tmp_path / "take.1", tmp_path / "take.2")
    assert (ran.code, ran.err) == (0, "")
    assert {name: each["name"] for name, each in _summaries(tmp_path / "out").items()} == {
        "take.1": "take.1",
        "take.2": "take.2",
    }


@pytest.mark.parametrize("word", ["", "*", "**/[ot]*"])
def test_a_folder_of_videos_and_a_pattern_stand_for_what_is_in_them(segment_all, clips, tmp_path, word):
    (clips / "notes.txt").unlink()
    ran = segment_all(clips / word if word else clips)
    assert (ran.code, ran.err) == (0, "")
    assert {*_summaries(tmp_path / "out")} == {"one", "two", "three"}


def test_a_pattern_that_fits_one_video_has_a_folder_of_its_name_too(segment_all, clips, tmp_path):
    assert segment_all(clips / "on*").code == 0
    assert {*_summaries(tmp_path / "out")} == {"one"}


def test_results_in_a_folder_of_videos_are_no_videos(segment_all, clips, tmp_path):
    assert segment_all(clips / "one.mp4", options=("--out", clips)).code == 0
    assert (clips / "overlay.mp4").exists()
    assert segment_all(clips).code == 0
    assert {*_summaries(tmp_path / "out")} == {"one", "two", "three"}


def test_a_video_named_twice_is_segmented_once(segment_all, clips):
    ran = segment_all(clips / "one.mp4", clips / "two.mp4", clips / ".." / "clips" / "one.mp4")
    assert (ran.code, len(_results(ran.out))) == (0, 2)


def test_videos_are_segmented_in_the_order_in_which_they_are_named(segment_all, clips):
    ran = segment_all(clips / "two.mp4", clips / "one.mp4", clips / "two.mp4")
    assert [line.partition("/masks")[0].rpartition("/")[2] for line in _results(ran.out)] == ["two", "one"]


def test_links_have_results_of_their_own_names(segment_all, clips, tmp_path):
    for name in ("beach", "hill"):
        (tmp_path / "links").mkdir(exist_ok=True)
        (tmp_path / "links" / f"{name}.mp4").symlink_to(clips / "one.mp4")
    (tmp_path / "links" / "walk").symlink_to(clips / "three", target_is_directory=True)
    assert segment_all(tmp_path / "links").code == 0
    summaries = _summaries(tmp_path / "out")
    assert {name: summary["name"] for name, summary in summaries.items()} == {n: n for n in ("beach", "hill", "walk")}


def test_one_bad_video_leaves_the_others_their_results(segment_all, clips, tmp_path):
    (clips / "bad.mp4").write_text("<html>")
    ran = segment_all(clips)
    assert ran.code == 2
    first, last = ran.err.splitlines()
    assert "not a video" in first and str(clips / "bad.mp4") in first
    assert "1 of 4 videos not segmented" in last and str(clips / "bad.mp4") in last
    assert {*_summaries(tmp_path / "out")} == {"one", "two", "three"}


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("https://example.org/a.mp4",), ("an address", "curl -LO")),
        (("clips/*.mov",), ("nothing fits the pattern", "clips/*.mov")),
        (("clips/three/*.png",), ("images in place of a video", "5 images", "their folder (clips/three)")),
        (("clips/three/00000.png", "clips/three/00001.png"), ("images in place of a video", "(clips/three)")),
        (("clips/one.mp4", "other/one.mp4"), ("two videos called 'one'", "clips/one.mp4 and other/one.mp4")),
        (("clips/one.mp4", "  "), ("no video named",)),
        (("clips/one.mp4", "gone.mp4"), ("file does not exist", "gone.mp4")),
    ],
)
def test_words_that_name_no_video_are_answered_by_what_they_are(
    segment_all, clips, write_video, monkeypatch, tmp_path, words, expected
):
    write_video("other/one.mp4")
    monkeypatch.chdir(tmp_path)
    ran = segment_all(*words)
    assert ran.code == 2
    assert all(word in ran.err for word in expected), ran.err
    assert "Traceback" not in ran.err


def test_one_page_is_not_for_several_videos(segment_all, clips, tmp_path, assert_refused):
    ran = segment_all(clips, options=("--report", tmp_path / "page.html"))
    assert_refused(ran, "one page for several videos", "--report")
    assert not (tmp_path / "out").exists()


def _contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("other", ["clips/two.mp4", "other/one.mp4", "clips/three"])
def test_a_second_video_never_goes_into_the_folder_of_the_first(
    segment_all, clips, write_video, frames, tmp_path, assert_refused, other
):
    # Of the same name, but another one.
    write_video("other/one.mp4", [image[::-1] for image in frames])
    assert segment_all(clips / "one.mp4").code == 0
    before = _contents(tmp_path / "out")
    called = "another video called 'one'" if other == "other/one.mp4" else "those of 'one'"
    assert_refused(segment_all(tmp_path / other), "the results of another video", tmp_path / "out", called, "--out")
    assert _contents(tmp_path / "out") == before


def test_the_same_video_may_be_moved_renamed_or_segmented_anew(segment_all, clips, tmp_path):
    assert segment_all(clips / "one.mp4").code == 0
    shutil.copy(clips / "one.mp4", tmp_path / "renamed.mp4")
    assert segment_all(tmp_path / "renamed.mp4", options=("--start", "1", "--quality", "default")).code == 0
    assert segment_all(clips / "one.mp4").code == 0


def test_frames_that_are_appended_to_a_folder_leave_it_the_same_video(segment_all, write_folder, frames):
    folder, whole = write_folder("growing", frames[:4]), write_folder("whole", frames)
    assert segment_all(folder).code == 0
    shutil.copytree(whole, folder, dirs_exist_ok=True)
    assert segment_all(folder, options=("--end", "4")).code == 0
    assert segment_all(folder, options=("--start", "2")).code == 0


def test_results_without_a_digest_are_known_by_their_name(segment_all, clips, tmp_path, assert_refused):
    assert segment_all(clips / "one.mp4").code == 0
    path = tmp_path / "out" / "motion.json"
    summary = json.loads(path.read_text())
    del summary["video"], summary["numbers"]
    path.write_text(json.dumps(summary))
    assert_refused(segment_all(clips / "two.mp4"), "the results of another video", "those of 'one'")
    assert segment_all(clips / "one.mp4").code == 0


def test_standard_input_is_read_as_a_video(clips, store, tmp_path):
    words = ["segment", "-", "--quality", "fast", "--quiet", "--set", "max_side=32", "--store", store]
    command = [sys.executable, "-m", "moseg", *map(str, words), "-o", str(tmp_path / "out")]
    with (clips / "one.mp4").open("rb") as video:
        ran = subprocess.run(command, stdin=video, capture_output=True, text=True, check=False)
    assert (ran.returncode, ran.stderr) == (0, "")
    assert _summaries(tmp_path / "out")["out"]["name"] == "stdin"


@pytest.mark.parametrize("content", [b"", b"no video"])
def test_standard_input_that_is_no_video_is_one_line(segment_all, monkeypatch, assert_refused, content):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(content)))
    assert_refused(segment_all("-"), "not a video" if content else "no video on standard input")


def test_a_terminal_is_no_video(segment_all, monkeypatch, assert_refused):
    terminal = io.TextIOWrapper(io.BytesIO(b""))
    monkeypatch.setattr(terminal, "isatty", lambda: True, raising=False)
    monkeypatch.setattr(sys, "stdin", terminal)
    assert_refused(segment_all("-"), "no video on standard input", "a terminal", "moseg segment -")


def test_a_file_may_be_named_as_a_pattern_or_a_dash(segment_all, clips, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    shutil.copy(clips / "one.mp4", "take[1].mp4")
    shutil.copy(clips / "two.mp4", "-")
    assert segment_all("take[1].mp4").code == 0
    assert segment_all("./-", options=("--out", "other")).code == 0
    assert json.loads(Path("other/motion.json").read_text())["name"] == "-"


def test_missing_frames_are_named_after_the_run(segment_all, write_folder, frames):
    folder = write_folder("frames", [*frames, *frames])
    for number in (2, 3, 7):
        (folder / f"{number:05d}.png").unlink()
    ran = segment_all(folder)
    assert (ran.code, ran.err) == (0, "")
    assert ran.out.splitlines()[1].startswith(f"note: frames 2-3, 7 missing in {folder}")
    assert "note:" not in segment_all(folder, options=("--end", "2")).out
    assert "note: frame 7 missing" in segment_all(folder, options=("--start", "2", "--every", "2")).out
