"""A name that is almost right: one line says which was meant."""

from pathlib import Path

import pytest

pytestmark = pytest.mark.usefixtures("in_empty_folder")


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        ("evl", "eval"),
        ("store lss", "ls"),
        ("confg dump", "config"),
        ("weights fech", "fetch"),
        ("eval --datset synthetic", "--dataset"),
        ("eval --quite", "--quiet"),
        ("store gc --forgt x", "--forget"),
        ("--versoin", "--version"),
        ("eval --dataset davis17", "davis16"),
        ("datasets show davis17", "davis16"),
        ("eval --variant fuse", "fused"),
        ("segment . --variant oc-dept", "oc-depth"),
        ("eval --dataset kt3dmoseg --variant oc-depht", "oc-depth"),
        ("eval --preset papre", "paper"),
        ("eval --quality bset", "best"),
        ("eval --geometry papr", "paper"),
        ("weights fetch --preset modrn", "modern"),
        ("weights fetch raft-lrage", "raft-large"),
        ("weights verify pisp", "pips"),
        ("eval --flow rafft", "raft"),
        ("eval --depth dpt-dinov", "dpt-dinov2"),
        ("eval --tracks pip", "pips"),
        ("eval --proposals groundtrut", "groundtruth"),
        ("eval --affinity residul", "residual"),
        ("eval --motions aut", "auto"),
        ("eval --preset paper --tagger ramplus", "ram-plus"),
        ("eval --device cud", "cuda"),
        ("eval --sequences occlusoin", "occlusion"),
        ("eval --set flow.methd=raft", "flow.method"),
        ("eval --set flwo.method=raft", "flow"),
        ("eval --set clustering.count.gpa=3", "clustering.count.gap"),
        ("eval --set ork_threshold=3", "affinity.ork_threshold"),
        ("score --predictions . --format volum", "volume"),
        ("export . --to davs", "davis"),
        ("segment . --overlay outlin", "outline"),
    ],
)
def test_what_was_meant_is_said_in_one_line(moseg, arguments, meant):
    ran = moseg(*arguments.split())
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert line.startswith("moseg: ")
    assert "did you mean" in line
    assert f"'{meant}'?" in line


def test_what_resembles_nothing_is_answered_by_what_there_is(moseg):
    ran = moseg("eval", "--dataset", "zzz")
    assert "one of davis-moving, davis16" in ran.err
    assert "did you mean" not in ran.err
    ran = moseg("store")
    assert ran.code == 2
    assert "ls, show, why" in ran.err


def test_a_run_or_task_that_is_almost_right(evaluated, moseg):
    run = moseg("status", "--store", evaluated.store).out
    assert run
    ran = moseg("status", "latets", "--store", evaluated.store)
    assert ran.code == 2
    assert "'latest'?" in ran.err
    ran = moseg("store", "ls", "--task", "flwo", "--store", evaluated.store)
    assert ran.code == 2
    assert "'flow'?" in ran.err


@pytest.mark.parametrize(
    ("arguments", "example"),
    [("segment", "moseg segment holiday.mp4"), ("score", "moseg score --dataset"), ("store why", "moseg store why")],
)
def test_what_is_missing_is_shown_by_an_example(moseg, arguments, example):
    ran = moseg(*arguments.split())
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert "issing" in line
    assert example in line
    assert f"moseg {arguments} --help" in line


@pytest.mark.parametrize(
    ("word", "meant"),
    [
        ("holiday.mp4", "moseg segment holiday.mp4"),
        ("my frames/", "moseg segment 'my frames/'"),
        ("clips/*.mov", "moseg segment 'clips/*.mov'"),
        ("it's.webm", "moseg segment 'it'\"'\"'s.webm'"),
    ],
)
def test_a_video_without_a_command_is_to_be_segmented(moseg, word, meant):
    ran = moseg(word)
    assert (ran.code, ran.out) == (2, "")
    (line,) = ran.err.splitlines()
    assert f"did you mean `{meant}`?" in line


def test_a_folder_that_exists_is_a_video_whatever_its_name(moseg):
    Path("recordings").mkdir()
    assert "moseg segment recordings" in moseg("recordings").err
    assert "did you mean" not in moseg("frobnicate").err
