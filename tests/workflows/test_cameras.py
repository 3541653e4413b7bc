"""Cameras by a network: recipes that read them, and runs on tiny checkpoints."""

import re

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.store import open_store
from moseg.workflows.graph import SequenceGraph, SequenceLeaves
from moseg.workflows.stages.needed_weights import needed_items

METHODS = ("depth-anything-3", "depth-anything-3-rays")
ITEM = "depth-anything-3-base"
NUM_FRAMES = 12
OPTIONS = ("--proposals", "tracks", "--section-length", "6", "--quiet")
AFTER_RIGIDITY = {"rigidity", "moving_tracks", "track_surfaces", "track_groups", "track_objects"}
AFTER_RIGIDITY |= {"object_points", "proposals"}


def _ref(task, text):
    return f"{task}/{digest_bytes('test', text.encode())}"


def _graph(num_frames=20, changed="", **changes):
    values = {"proposal_source": "tracks", "sections": {"length": 8}, "track_window": {"min_frames": 10}}
    config = PipelineConfig.model_validate(values | changes)
    weights = {name: _ref("weights", name + changed) for name in needed_items(config)}
    frames = tuple(_ref("frame", str(number)) for number in range(num_frames))
    graph = SequenceGraph(SequenceLeaves("toy", (48, 64), frames, weights=weights), config)
    graph.segmentations(Variant.FUSED)
    return graph


def _recipes(graph, stage):
    return [recipe for recipe in graph.recipes.values() if recipe.task == stage]


def _tasks(refs):
    return {ref.partition("/")[0] for ref in refs}


def test_by_default_no_recipe_names_cameras():
    graph = _graph()
    assert not _recipes(graph, "cameras") and needed_items(PipelineConfig()) == {}
    for recipe in _recipes(graph, "rigidity"):
        assert "cameras" not in recipe.inputs
        assert not [name for name in recipe.params if name.startswith(("camera_", "depth_"))]


@pytest.mark.parametrize("method", METHODS)
def test_each_window_has_cameras_which_its_rigidity_reads(method):
    graph = _graph(cameras={"method": method})
    cameras = {recipe.ref: recipe for recipe in _recipes(graph, "cameras")}
    assert {recipe.inputs["weights"] for recipe in cameras.values()} == set(graph.leaves.weights.values())
    for recipe in _recipes(graph, "rigidity"):
        assert cameras[recipe.inputs["cameras"]].inputs["frames"] == recipe.inputs["frames"]
        assert "depth" not in recipe.inputs


def test_cameras_change_what_is_found_with_them_alone():
    plain, given = _graph(), _graph(cameras={"method": "depth-anything-3"})
    moved = _tasks(given.recipes.keys() - plain.recipes.keys())
    assert moved >= AFTER_RIGIDITY | {"cameras"} and not moved & {"flow", "dense_tracks"}
    other = _graph(cameras={"method": "depth-anything-3"}, rigidity={"camera_slip": 4.0})
    assert "cameras" not in _tasks(other.recipes.keys() - given.recipes.keys())


def test_other_weights_give_other_cameras():
    first, second = (_graph(cameras={"method": "depth-anything-3"}, changed=text) for text in ("", "*"))
    assert _tasks(second.recipes.keys() - first.recipes.keys()) >= AFTER_RIGIDITY | {"cameras"}


def test_more_frames_keep_the_cameras_of_finished_windows():
    short, long = (_graph(number, cameras={"method": "depth-anything-3"}) for number in (28, 60))
    kept = [recipe for recipe in _recipes(short, "cameras") if recipe.ref in long.recipes]
    assert 0 < len(_recipes(short, "cameras")) - len(kept) <= 2


def test_cameras_and_depth_read_one_weights_item():
    config = PipelineConfig(depth={"method": "depth-anything-3"}, cameras={"method": "depth-anything-3-rays"})
    assert needed_items(config) == {ITEM: "depth_anything_3"}


@pytest.fixture(scope="module")
def tiny(tmp_path_factory):
    """Return a folder with a tiny checkpoint."""
    from moseg.workflows.cli.app import run

    folder = tmp_path_factory.mktemp("tiny")
    assert run(["weights", "tiny", str(folder), "--only", ITEM]) == 0
    return folder


@pytest.fixture
def segment(moseg, tiny, write_squares, tmp_path, monkeypatch):
    """Return a function that segments a video with cameras and returns its store and the number of its artifacts."""
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tiny))
    monkeypatch.setenv("MOSEG_OFFLINE", "1")
    video = write_squares(tmp_path / "clip", num_frames=NUM_FRAMES) / "frames"

    def call(folder, method, *arguments):
        outputs = ("--store", tmp_path / folder / "store", "--out", tmp_path / folder / "out")
        ran = moseg("segment", video, *outputs, *OPTIONS, "--set", f"cameras.method={method}", *arguments)
        assert ran.code == 0, ran.err
        computed = int(re.search(r"(\d+) artifacts computed", ran.out)[1])
        return open_store(str(tmp_path / folder / "store"), create=False), computed

    return call


def _contents(store):
    arrays = {}
    for ref in store.refs():
        for array in store.manifest(ref).arrays:
            arrays[ref, array.name] = np.ascontiguousarray(store.read(ref, array.name)).tobytes()
    return arrays


@pytest.mark.parametrize("method", METHODS)
def test_cameras_reach_the_masks_and_two_workers_leave_the_same_bytes(method, segment, tmp_path):
    store, computed = segment("alone", method)
    assert computed > 0 and segment("alone", method)[1] == 0
    found = [ref for ref in store.refs() if ref.startswith("cameras/")]
    assert found
    for ref in found:
        pairs, pose, intrinsics, depth = (
            store.read(ref, name) for name in ("pairs", "pose", "intrinsics", "inverse_depth")
        )
        assert set(pairs[:, 1]) == {2, 4} and pose.shape == (len(pairs), 3, 4) and pose.dtype == np.float64
        assert intrinsics.shape == (len(depth), 3, 3) and depth.shape[1:] == (96, 128)
        assert np.isfinite(pose).all() and (depth > 0).all()
    masks = [path.read_bytes() for path in sorted((tmp_path / "alone" / "out" / "masks").glob("*.png"))]
    both, _ = segment("together", method, "--workers", "2")
    assert _contents(both) == _contents(store)
    again = [path.read_bytes() for path in sorted((tmp_path / "together" / "out" / "masks").glob("*.png"))]
    assert len(masks) == NUM_FRAMES and again == masks


@pytest.mark.parametrize("arguments", [("--proposals", "saliency"), ("--set", "rigid_support.use=never")])
def test_weights_that_no_node_reads_are_not_fetched(arguments, moseg, write_squares, tmp_path, monkeypatch):
    monkeypatch.setenv("MOSEG_WEIGHTS", str(tmp_path / "nothing"))
    video = write_squares(tmp_path / "clip", num_frames=NUM_FRAMES) / "frames"
    outputs = ("--store", tmp_path / "store", "--out", tmp_path / "out", "--quiet", "--offline")
    ran = moseg("segment", video, *outputs, "--set", "cameras.method=depth-anything-3", *arguments)
    assert ran.code == 0, ran.err
    # Those of a network that runs are asked for.
    ran = moseg("segment", video, *outputs, *arguments, "--flow", "raft")
    assert ran.code == 2 and "moseg weights fetch raft-large" in ran.err
