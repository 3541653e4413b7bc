"""Corrections of a part of a video say which part it is, and a run on another part says so."""

import pytest

SETTINGS = ("--section-length", "4", "--set", "sections.overlap=2", "--quality", "fast", "--quiet")


@pytest.fixture
def segment(moseg, squares, tmp_path, in_empty_folder):
    """Return a function that runs `moseg segment` on the squares, or another video, with options."""

    def call(*options, out, video=squares / "squares" / "frames"):
        ran = moseg("segment", video, "--out", tmp_path / out, "--store", tmp_path / "store", *SETTINGS, *options)
        assert (ran.code, ran.err) == (0, "")
        return ran.out

    return call


def _notes(printed):
    return [line for line in printed.splitlines() if "was written for" in line]


@pytest.mark.parametrize(
    ("options", "part"), [((), "all frames"), (("--start", "2"), "8 frames, 00002.png to 00009.png")]
)
def test_a_note_names_the_part_that_corrections_were_written_for(segment, tmp_path, options, part):
    segment("--start", "1", "--drop", "1", out="first")
    file = tmp_path / "first" / "corrections.yaml"
    assert 'part: "9 frames, 00001.png to 00009.png"\n' in file.read_text()
    (note,) = _notes(segment("--corrections", file, *options, out="second"))
    assert note.startswith(f"note: {file} was written for 9 frames, 00001.png to 00009.png, and this run reads {part}:")
    assert not _notes(segment("--start", "1", "--corrections", file, out="first"))


def test_frames_of_a_video_have_numbers(segment, tmp_path):
    segment(out="whole")
    video = tmp_path / "whole" / "overlay.mp4"
    segment("--end", "6", "--every", "2", "--drop", "1", out="part", video=video)
    file = tmp_path / "part" / "corrections.yaml"
    assert 'part: "3 frames, 0 to 4"\n' in file.read_text()
    (note,) = _notes(segment("--end", "7", "--corrections", file, out="another", video=video))
    assert "was written for 3 frames, 0 to 4, and this run reads 7 frames, 0 to 6:" in note


def test_corrections_without_a_video_are_of_any_part(segment, tmp_path):
    (tmp_path / "fixes.yaml").write_text("version: 1\nedits: [{drop: 1}]\n")
    assert not _notes(segment("--start", "1", "--corrections", tmp_path / "fixes.yaml", out="out"))
