"""Corrections that cannot be applied are refused in one line."""

import pytest

WRONG = {
    "no such object in --drop 7; got 7; expected one of 1, 2": ["--drop", "7"],
    "no such object in --drop 1; got 1; expected one of 2": ["--merge", "2,1", "--drop", "1"],
    "no such frame in --split 2@50; got 50; expected 0 to 9": ["--split", "2@50"],
    "a number in use in --split 2@5:1; got 1; expected a number not in use, such as 3": ["--split", "2@5:1"],
    "not a correction in --split; got 2; expected OBJECT@FRAME, such as 2@31, or 2@31:7": ["--split", "2"],
    "not a correction in --merge; got 1,x; expected numbers of objects, separated by commas": ["--merge", "1,x"],
    "not a correction in --rename; got 1; expected OBJECT=NAME, such as 2=bear": ["--rename", "1"],
    "bad corrections in --merge 1; got [1]; expected at least 2": ["--merge", "1"],
    "bad corrections in --merge 1,1; got [1, 1]; expected objects that differ": ["--merge", "1,1"],
    "bad corrections in --split 0@5:3: object; got 0; expected": ["--split", "0@5:3"],
    "bad corrections in --split 2@0: frame; got 0; expected": ["--split", "2@0"],
    "bad corrections in --rename 2=: name; got ''; expected": ["--rename", "2="],
    "bad corrections in --drop 1,0; got 0; expected": ["--drop", "1,0"],
    "no such corrections file in none.yaml": ["--corrections", "none.yaml"],
}


@pytest.mark.parametrize("line", WRONG)
def test_a_wrong_option_is_one_line(segment, line):
    ran = segment(*WRONG[line])
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(f"moseg: {line}") and ran.err.count("\n") == 1, ran.err


FILES = {
    "no such object in fixes.yaml: edit 2 (drop); got 7; expected one of 1, 2": "edits:\n- keep: 1\n- drop: 7\n",
    "corrections of another video in fixes.yaml; got those of video abab": f"video: '{'ab' * 32}'\n",
    "an unknown kind of edit in fixes.yaml: edit 1; got 'dorp'; expected drop?": "edits:\n- dorp: 7\n",
    "bad parameter in fixes.yaml: clustering.threshold; got '7'": "settings: {clustering.threshold: 7}\n",
    "no ground truth of your own video in --motions; got gt": "settings: {clustering.motions: gt}\n",
}


@pytest.mark.parametrize("line", FILES)
def test_a_wrong_file_is_one_line(segment, in_empty_folder, line):
    with open("fixes.yaml", "w") as file:
        file.write("version: 1\n" + FILES[line])
    ran = segment("--corrections", "fixes.yaml")
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(f"moseg: {line}") and ran.err.count("\n") == 1, ran.err


def test_several_videos_cannot_be_corrected_at_once(moseg, frames, in_empty_folder):
    ran = moseg("segment", frames, frames.parent / "masks", "--drop", "1")
    assert (ran.code, ran.err.count("\n")) == (2, 1)
    assert "corrections of several videos in --drop; got 2 videos; expected one video" in ran.err
