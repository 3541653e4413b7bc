"""The presets with networks, from a video to its masks, on tiny checkpoints in the published formats."""

import json
import re
import shutil
from functools import cache

import numpy as np
import pytest
from PIL import Image

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.presets import PRESETS
from moseg.store import open_store
from moseg.workflows.stages.needed_weights import needed_items

NUM_FRAMES = 12
SECTIONS = ("--section-length", "6")
STAGES = {"tags", "detections", "instances", "seeds", "proposals", "flow", "depth", "tracks"}


@pytest.fixture(scope="module")
def video(tmp_path_factory, write_squares):
    """Return a video of twelve frames with two moving squares."""
    return write_squares(tmp_path_factory.mktemp("video") / "clip", num_frames=NUM_FRAMES) / "frames"


@pytest.fixture(scope="module")
def left_by(tiny, video, tmp_path_factory):
    """Return a function that gives the folder of store and masks of a preset, which runs once."""
    from moseg.workflows.cli.app import run

    @cache
    def segment_once(preset):
        folder = tmp_path_factory.mktemp(preset)
        words = ("segment", video, "--store", folder / "store", "--out", folder / "out", "--quiet", *SECTIONS)
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv("MOSEG_WEIGHTS", str(tiny))
            patch.setenv("MOSEG_OFFLINE", "1")
            assert run([*map(str, words), "--preset", preset]) == 0
        return folder

    return segment_once


@pytest.fixture
def copy_of(left_by, tmp_path):
    """Return a function that copies the files of a preset's run to where `segment` finds them."""

    def call(preset):
        shutil.copytree(left_by(preset), tmp_path, dirs_exist_ok=True)

    return call


@pytest.fixture
def weights(tiny, tmp_path, monkeypatch):
    """Return the folder of a test's own copy of the tiny checkpoints, which is set as the weights folder."""
    folder = tmp_path / "weights"
    shutil.copytree(tiny, folder)
    monkeypatch.setenv("MOSEG_WEIGHTS", str(folder))
    monkeypatch.setenv("MOSEG_OFFLINE", "1")
    return folder


@pytest.fixture
def segment(moseg, video, weights, tmp_path):
    """Return a function that runs `moseg segment` on the video and returns the computed artifacts and the outcome."""

    def call(*arguments):
        store, out = ("--store", tmp_path / "store"), ("--out", tmp_path / "out")
        ran = moseg("segment", video, *store, *out, "--quiet", *SECTIONS, *arguments)
        found = re.search(r"(\d+) artifacts computed", ran.out)
        return int(found[1]) if found else None, ran

    return call


def _stored(tmp_path):
    """Return the keys of every stage in the test's store."""
    found = {}
    for path in (tmp_path / "store" / "objects").glob("*/*/*"):
        found.setdefault(path.parent.parent.name, set()).add(path.name)
    return found


def _labels(path):
    with Image.open(path) as image:
        return np.array(image)


@pytest.mark.parametrize("preset", ["paper", "modern"])
def test_a_preset_runs_from_the_video_to_its_masks_and_a_second_run_computes_nothing(
    preset, segment, copy_of, tmp_path
):
    copy_of(preset)
    assert _stored(tmp_path).keys() >= STAGES
    masks = sorted((tmp_path / "out" / "masks").glob("*.png"))
    assert len(masks) == NUM_FRAMES and all(_labels(path).shape == (96, 128) for path in masks)
    summary = json.loads((tmp_path / "out" / "motion.json").read_text())
    assert all(found["tag"] for found in summary["objects"])
    again, ran = segment("--preset", preset)
    assert ran.code == 0 and again == 0


def test_tiny_networks_find_an_object_in_the_first_and_last_frame(segment, copy_of, tmp_path):
    copy_of("paper")
    _, ran = segment("--preset", "paper", "--variant", "base")
    assert ran.code == 0, ran.err
    labels = [_labels(path) for path in sorted((tmp_path / "out" / "masks").glob("*.png"))]
    first, last = (set(np.unique(frame)) - {0} for frame in (labels[0], labels[-1]))
    assert first & last


@pytest.mark.parametrize(
    ("architecture", "moved", "kept"),
    [
        ("raft", {"flow", "flow_model"}, {"tags", "detections", "instances", "proposals", "depth", "tracks"}),
        ("dpt_dinov2", {"depth", "flow_model"}, {"tags", "proposals", "flow", "tracks", "fundamental"}),
        ("pips", {"tracks", "fundamental"}, {"proposals", "flow", "depth", "flow_model"}),
        ("deaot", {"proposals", "tracks", "flow_model"}, {"tags", "detections", "instances", "flow", "depth"}),
    ],
)
def test_another_weights_file_recomputes_its_stage_and_those_downstream(
    architecture, moved, kept, segment, copy_of, weights, moseg, tmp_path
):
    copy_of("paper")
    before = _stored(tmp_path)
    items = needed_items(PipelineConfig.model_validate(PRESETS["paper"]))
    (item,) = (name for name, needed in items.items() if needed == architecture)
    assert moseg("weights", "tiny", weights, "--seed", "1", "--only", item).code == 0
    computed, ran = segment("--preset", "paper")
    assert ran.code == 0, ran.err
    after = _stored(tmp_path)
    assert computed > 0
    for stage in moved:
        assert after[stage] - before[stage], stage
    for stage in kept | {"frame"}:
        assert after[stage] == before[stage], stage


@pytest.mark.parametrize(("tracks", "depth"), [("pips", "depth-anything-v2"), ("bootstapir", "depth-anything-3")])
def test_stages_can_be_chosen_one_by_one(tracks, depth, segment):
    _, ran = segment("--flow", "raft", "--depth", depth, "--tracks", tracks)
    assert ran.code == 0, ran.err


def test_tiny_checkpoints_are_made_for_every_choice_of_a_network(tiny):
    from moseg.workflows.stages.registry import all_choices
    from moseg.workflows.weights.folder import open_weights

    items = open_weights({"MOSEG_WEIGHTS": str(tiny)}, offline=True).items
    made = {item.architecture for name, item in items.items() if (tiny / name).is_dir()}
    networks = [backend.network for choice in all_choices() for backend in choice.backends if backend.network]
    assert made == {network.architecture for network in networks}


def test_sea_raft_leaves_flow_of_each_pair_that_a_second_run_does_not_compute(segment, tmp_path):
    computed, ran = segment("--flow", "sea-raft", "--device", "cpu")
    assert ran.code == 0 and computed > 0, ran.err
    store = open_store(str(tmp_path / "store"), create=False)
    flows = [ref for ref in store.refs() if ref.startswith("flow/")]
    assert len(flows) == 2 * (NUM_FRAMES - 1)
    assert all(store.read(ref, "flow").shape == (96, 128, 2) for ref in flows)
    assert segment("--flow", "sea-raft", "--device", "cpu")[0] == 0
    assert segment("--flow", "sea-raft", "--set", "sea_raft.iterations=2")[0] > 0


def test_sea_raft_computes_the_same_bytes_again_on_the_cpu(segment, contents_of, tmp_path):
    stores = []
    for _ in range(2):
        assert segment("--flow", "sea-raft", "--device", "cpu")[1].code == 0
        stores.append(contents_of(tmp_path / "store"))
        shutil.rmtree(tmp_path / "store")
    assert stores[0] == stores[1]


def test_given_tags_skip_the_tagger(segment, copy_of, weights, tmp_path):
    copy_of("paper")
    shutil.rmtree(tmp_path / "store" / "objects" / "tags")
    shutil.rmtree(weights / "ram")
    _, ran = segment("--preset", "paper", "--tags", "car,person")
    assert ran.code == 0, ran.err
    assert "tags" not in _stored(tmp_path)


def test_frames_in_one_pass_give_the_keys_of_frames_one_by_one(segment):
    assert segment("--flow", "raft", "--depth", "dpt-dinov2", "--batch", "4")[1].code == 0
    assert segment("--flow", "raft", "--depth", "dpt-dinov2", "--batch", "1")[0] == 0


def test_missing_weights_are_one_line_with_the_command_that_fetches_them(segment, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "nothing"))
    _, ran = segment("--flow", "raft", "--offline")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert "model.pth" in line and "moseg weights fetch raft-large" in line


def test_truncated_weights_are_one_line(segment, weights):
    path = weights / "raft-large" / "model.pth"
    path.write_bytes(path.read_bytes()[:1000])
    _, ran = segment("--flow", "raft")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert "model.pth" in line


@pytest.mark.parametrize(
    ("item", "preset"),
    [
        ("raft-large", "paper"),
        ("pips", "paper"),
        ("bootstapir", "modern"),
        ("dpt-dinov2-large-nyu", "paper"),
        ("depth-anything-3-base", "modern"),
        ("sam-hq-vit-large", "paper"),
        ("grounding-dino-tiny", "paper"),
        ("deaot-r50-l", "paper"),
        ("ram", "paper"),
        ("ram-plus", "modern"),
        ("sam2.1-hiera-large", "modern"),
        ("sea-raft-m", "modern"),
    ],
)
@pytest.mark.parametrize("how", ["missing", "unexpected"])
def test_tensors_of_another_network_are_rejected(how, item, preset, segment, copy_of, weights):
    # What the network's stage reads is stored, so that it runs first.
    copy_of(preset)
    (path,) = (entry for entry in (weights / item).iterdir() if entry.suffix in (".pth", ".bin", ".safetensors"))
    _damage(path, how)
    _, ran = segment("--preset", preset)
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert item in line and "tensors" in line


def _damage(path, how):
    """Remove a tensor from a checkpoint, or add one."""
    import torch
    from safetensors.torch import load_file, save_file

    is_safe = path.suffix == ".safetensors"
    tensors = load_file(path) if is_safe else torch.load(path, weights_only=True)
    inner = next((value for value in tensors.values() if isinstance(value, dict)), tensors)
    if how == "missing":
        del inner[sorted(inner)[len(inner) // 2]]
    else:
        inner["an_unknown.weight"] = torch.zeros(3)
    save_file(tensors, path) if is_safe else torch.save(tensors, path)


def test_two_workers_give_the_bytes_of_one_process(left_by, moseg, contents_of, video, weights, tmp_path):
    arguments = ("--store", tmp_path / "other", "--out", tmp_path / "out", "--quiet", *SECTIONS)
    assert moseg("segment", video, *arguments, "--preset", "paper", "--workers", "2").code == 0
    assert contents_of(tmp_path / "other") == contents_of(left_by("paper") / "store")


def test_why_names_the_weights_file_that_changed(segment, moseg, copy_of, weights, tmp_path):
    copy_of("paper")
    assert moseg("weights", "tiny", weights, "--seed", "1", "--only", "raft-large").code == 0
    before = _stored(tmp_path)["flow"]
    assert segment("--preset", "paper")[1].code == 0
    new = _stored(tmp_path)["flow"] - before
    assert new
    for key in new:
        explained = moseg("store", "why", key, "--store", tmp_path / "store").out
        assert "params.files.model.pth" in explained


def test_networks_without_their_libraries_are_one_line(segment, monkeypatch):
    monkeypatch.setattr("moseg.workflows.weights.reading.find_spec", lambda name: None if name == "torch" else name)
    assert segment()[1].code == 0
    _, ran = segment("--flow", "raft")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert "torch" in line and "pip install 'moseg[models]'" in line


def test_an_invalid_video_is_reported_before_weights_are_looked_for(moseg, video, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "nothing"))
    (tmp_path / "one").mkdir()
    shutil.copy(sorted(video.iterdir())[0], tmp_path / "one")
    ran = moseg("segment", tmp_path / "one", "--preset", "paper", "--offline", "--store", tmp_path / "store", "--quiet")
    assert ran.code == 2 and "too few frames" in ran.err


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--flow", "raft", "--tracks", "pips", "--set", "raft.weights=pips"), ("pips", "two networks")),
        (("--preset", "paper", "--tags", "car", "--tagger", "ram"), ("--tagger", "--tags car")),
        (("--tags", "car"), ("--tags", "--proposals detections")),
        (("--preset", "papr"), ("papr", "paper")),
        (("--preset", "paper", "--tags", " ,"), ("detections.tags", "names of objects")),
        (("--flow", "raft", "--set", "raft.weights=raft-lrge"), ("raft-lrge", "raft-large")),
        (("--flow", "raft", "--device", "cuda:77"), ("--device", "cuda:77")),
        (("--flow", "raft", "--batch", "0"), ("--batch", "0")),
    ],
)
def test_contradictory_options_are_one_line(segment, options, words):
    _, ran = segment(*options)
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert all(word in line for word in words), line
