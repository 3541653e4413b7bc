"""`moseg train`: interrupted and continued, what it leaves, and bad input."""

import hashlib
import json
import shutil
import sys

import numpy as np
import pytest

from moseg.tasks.motion_network import read_network
from moseg.tasks.network_training.learner import Learner
from moseg.workflows.training import steps
from moseg.workflows.training.drawing import draw_shards
from moseg.workflows.training.shards import SAMPLES, plan_shards

pytestmark = pytest.mark.usefixtures("in_empty_folder")


@pytest.fixture
def folder(scene_files, tmp_path):
    return shutil.copytree(scene_files, tmp_path / "work")


@pytest.mark.parametrize("damaged", [b"", b"PK", b"PK\3\4 and more", "its first half"])
def test_a_complete_shard_is_kept_and_a_damaged_one_drawn_again(damaged, folder):
    (shard,) = plan_shards(folder / "scenes", 0, 0, 2, 2)
    files = sorted((folder / "scenes").rglob("0000-*.npy"))
    before = {file: (file.read_bytes(), file.stat().st_mtime_ns) for file in files}
    assert len(files) == 3
    draw_shards([shard], 1, quiet=True)
    assert {file: file.stat().st_mtime_ns for file in files} == {file: time for file, (_, time) in before.items()}
    files[0].write_bytes(before[files[0]][0][:1000] if isinstance(damaged, str) else damaged)
    files[1].unlink()
    draw_shards([shard], 1, quiet=True)
    assert {file: file.read_bytes() for file in files} == {file: content for file, (content, _) in before.items()}


def test_shards_hold_all_samples_once(tmp_path):
    shards = plan_shards(tmp_path, 0, 5, 2 * SAMPLES + 7, 2)
    assert [(shard.index, shard.num_samples) for shard in shards] == [(5, SAMPLES), (6, SAMPLES), (7, 7)]


def test_an_interrupted_training_ends_with_the_same_bytes(moseg, options, folder, scene_files, monkeypatch, tmp_path):
    whole = shutil.copytree(scene_files, tmp_path / "whole")
    assert moseg(*options, "--folder", whole, "--out", "whole.onnx").code == 0
    monkeypatch.setattr(steps, "CHECKPOINT_STEPS", 1)
    taken, learn = [], Learner.learn

    def learn_or_stop(learner, loss_of):
        if len(taken) == 3:
            raise KeyboardInterrupt
        taken.append(learner.step)
        return learn(learner, loss_of)

    monkeypatch.setattr(Learner, "learn", learn_or_stop)
    assert moseg(*options, "--folder", folder, "--out", "cut.onnx").code == 130
    assert not (tmp_path / "cut.onnx").exists()
    taken[:] = [-1]
    assert moseg(*options, "--folder", folder, "--out", "cut.onnx").code == 0
    assert taken == [-1, 3]
    with open("whole.onnx", "rb") as first, open("cut.onnx", "rb") as second:
        assert first.read() == second.read()
    curves = [json.loads((each / "curve.json").read_text()) for each in (whole, folder)]
    assert [entry["loss"] for entry in curves[0]] == [entry["loss"] for entry in curves[1]]


def test_the_recipe_names_the_file(moseg, options, folder, tmp_path):
    ran = moseg(*options, "--folder", folder, "--out", tmp_path / "n.onnx")
    assert (ran.code, ran.err) == (0, "")
    assert "n.onnx: " in ran.out and "n.json" in ran.out
    content, recipe = (tmp_path / "n.onnx").read_bytes(), json.loads((tmp_path / "n.json").read_text())
    assert recipe["result"]["sha256"] == hashlib.sha256(content).hexdigest()
    assert recipe["result"]["bytes"] == len(content) <= 6_000_000
    assert (recipe["seed"], recipe["scenes"], recipe["steps"], recipe["result"]["step"]) == (0, 2, 4, 4)
    curve = json.loads((folder / "curve.json").read_text())
    assert [entry["step"] for entry in curve] == [2, 4]
    assert all(np.isfinite(entry["loss"]) for entry in curve)
    read_network(content)


def test_a_training_goes_on_from_a_network(moseg, options, folder, start, tmp_path):
    ran = moseg(*options, "--from", start, "--folder", folder, "--out", tmp_path / "further.onnx")
    assert (ran.code, ran.err) == (0, "")
    assert (
        json.loads((tmp_path / "further.json").read_text())["start"] == hashlib.sha256(start.read_bytes()).hexdigest()
    )
    # Its scores before the first step are those of the start, which the folder's other trainings do not begin with.
    curve = json.loads((folder / "curve.json").read_text())
    assert [entry["step"] for entry in curve] == [0, 2, 4] and curve[0]["loss"] is None
    ran = moseg(*options, "--folder", folder, "--out", tmp_path / "anew.onnx")
    assert ran.code == 2 and "start" in ran.err and "--folder" in ran.err


@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        ("--out network.pt", ".onnx"),
        ("--set nonsense=1", "nonsense"),
        ("--set rates=1", "did you mean 'rate'"),
        ("--set rate=fast", "'fast'"),
        ("--steps 0", "steps"),
        ("--set steps", "name=value"),
        ("--workers 100000", "--workers"),
        ("--device gpu", "--device"),
        ("--store cues", "--videos"),
        ("--from network.onnx", "network.onnx"),
    ],
)
def test_bad_use_is_one_line(moseg, arguments, word, tmp_path):
    ran = moseg("train", *arguments.split())
    assert ran.code == 2 and len(ran.err.splitlines()) == 1 and word in ran.err
    assert not list(tmp_path.rglob("*.npy"))


@pytest.mark.parametrize("package", ["torch", "onnx"])
def test_a_missing_package_is_named(moseg, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    ran = moseg("train")
    assert ran.code == 2 and len(ran.err.splitlines()) == 1
    assert f"training needs {package}" in ran.err and "moseg[models]" in ran.err


def test_a_checkpoint_of_another_training_is_refused(moseg, options, folder):
    assert moseg(*options, "--folder", folder).code == 0
    ran = moseg(*options, "--folder", folder, "--steps", "3")
    assert ran.code == 2 and "steps 4" in ran.err and "steps 3" in ran.err and "--folder" in ran.err


def test_a_damaged_checkpoint_is_named(moseg, options, folder):
    (folder / "checkpoint.pt").write_bytes(b"PK\x03\x04nonsense")
    ran = moseg(*options, "--folder", folder)
    assert ran.code == 2 and len(ran.err.splitlines()) == 1 and "checkpoint.pt" in ran.err
