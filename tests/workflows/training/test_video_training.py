"""`moseg train --videos`: from end to end on a short video, and bad input."""

import hashlib
import json
import shutil
from dataclasses import replace

import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.parameters import ClipParams
from moseg.tasks.motion_network import read_network
from moseg.workflows.datasets import SequenceSource
from moseg.workflows.pipelines.video_clips import cue_config, describe_clips
from moseg.workflows.sources import open_frames
from moseg.workflows.stages.registry import STAGES
from moseg.workflows.training import videos as video_training

pytestmark = pytest.mark.usefixtures("in_empty_folder")
TINY = ("--set=scenes=2", "--set=textures=2", "--set=batch=2", "--steps=2", "--set=interval=1", "--quiet")


@pytest.fixture
def videos(squares, tmp_path):
    folder = tmp_path / "videos"
    shutil.copytree(squares / "squares" / "frames", folder / "squares")
    return folder


def test_a_network_goes_on_from_videos_without_labels(moseg, start, videos, scene_files, tmp_path, monkeypatch):
    folder = shutil.copytree(scene_files, tmp_path / "work")
    options = ("train", "--videos", videos, "--from", start, "--folder", folder, "--workers", 1, "--threads", 1, *TINY)
    ran = moseg(*options, "--out", tmp_path / "mine.onnx")
    assert (ran.code, ran.err) == (0, "") and "mine.onnx: " in ran.out
    content, recipe = (tmp_path / "mine.onnx").read_bytes(), json.loads((tmp_path / "mine.json").read_text())
    assert recipe["result"]["sha256"] == hashlib.sha256(content).hexdigest() != recipe["start"]
    assert recipe["start"] == hashlib.sha256(start.read_bytes()).hexdigest()
    read_network(content)
    clips = {path: path.stat().st_mtime_ns for path in (folder / "clips").rglob("*.npz")}
    assert clips
    assert moseg(*options, "--out", tmp_path / "again.onnx").code == 0
    assert (tmp_path / "again.onnx").read_bytes() == content
    assert {path: path.stat().st_mtime_ns for path in clips} == clips
    # A checkpoint of losses on other scenes is no start.
    monkeypatch.setattr(video_training, "DRAWING_VERSION", 99)
    ran = moseg(*options, "--out", tmp_path / "other.onnx")
    assert ran.code == 2 and "scenes_version" in ran.err


@pytest.mark.parametrize("stage", ["flow", "background", "saliency"])
def test_clips_are_not_those_of_older_code(stage, videos, monkeypatch):
    source, config = SequenceSource("squares", open_frames(str(videos / "squares"), 427)), cue_config(PipelineConfig())
    before = describe_clips(source, config, ClipParams())
    assert describe_clips(source, config, ClipParams()) == before
    tasks = tuple(replace(task, version=task.version + 1) for task in STAGES[stage].tasks)
    monkeypatch.setitem(STAGES, stage, replace(STAGES[stage], tasks=tasks))
    assert describe_clips(source, config, ClipParams()) != before


def test_bad_videos_are_one_line(moseg, start, videos, tmp_path):
    (tmp_path / "empty").mkdir()
    (tmp_path / "text.onnx").write_text("not a network")
    short = tmp_path / "short" / "one"
    shutil.copytree(videos / "squares", short)
    for frame in sorted(short.iterdir())[2:]:
        frame.unlink()
    for arguments, words in (
        (("--videos", tmp_path / "empty", "--from", start), ("no videos", "empty")),
        (("--videos", "nowhere", "--from", start), ("nowhere",)),
        (("--videos", tmp_path / "short", "--from", start), ("long enough", "5 frames")),
        (("--videos", videos, "--from", tmp_path / "text.onnx"), ("not a motion network", "text.onnx")),
        (("--videos", videos, "--from", "nowhere.onnx"), ("nowhere.onnx",)),
        (("--videos", videos, "--set", "targets=-1"), ("targets",)),
    ):
        ran = moseg("train", *arguments, *TINY)
        assert ran.code == 2, (arguments, ran)
        assert len(ran.err.splitlines()) == 1
        assert all(word in ran.err for word in words), ran.err
