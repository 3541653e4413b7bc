"""The network trained on the video: from the graph to masks, the same for any number of workers."""

import hashlib

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig, Variant
from moseg.schemas.digests import digest_bytes
from moseg.store import open_store
from moseg.workflows.graph import SequenceGraph, SequenceLeaves

SMALL = {
    "sections.length": 4,
    "sections.overlap": 1,
    "video_network.use": "always",
    "video_network.stretch_length": 8,
    "video_network.steps": 4,
    "video_network.crops": 2,
    "video_network.crop_height": 48,
    "video_network.crop_width": 64,
}
"""Parameters of a training that takes a second."""


def _leaves(num_frames):
    frames = tuple(f"frame/{digest_bytes('test', str(number).encode())}" for number in range(num_frames))
    weights = f"motion_weights/{digest_bytes('test', b'')}"
    return SequenceLeaves(name="toy", shape=(48, 64), frames=frames, motion_weights=weights)


def _recipes(num_frames, **network):
    values = {"sections": {"length": 4, "overlap": 1}, "proposal_source": "saliency"}
    config = PipelineConfig.model_validate(values | {"video_network": {"stretch_length": 8} | network})
    graph = SequenceGraph(_leaves(num_frames), config)
    graph.segmentations(Variant.BASE)
    return graph.recipes


def _of(task, recipes, method=None):
    found = {ref: recipe for ref, recipe in recipes.items() if recipe.task == task}
    return {ref: each for ref, each in found.items() if method is None or each.params["method"] == method}


def test_a_network_is_only_trained_where_it_is_asked_for():
    without, trained = _recipes(16), _recipes(16, use="always")
    assert not _of("video_network", without) and not _of("motion_proof", without)
    assert not _of("foreground", without, "video-network")
    assert len(_of("video_network", trained)) == 2
    kept = {"saliency", "accumulation", "appearance"}
    assert all(_of(task, without).keys() == _of(task, trained).keys() for task in kept)


def test_every_section_gets_the_network_of_its_stretch():
    recipes = _recipes(22, use="always")
    refined = _of("foreground", recipes, "video-network")
    read = [recipe.inputs["video_network"] for recipe in refined.values()]
    networks = _of("video_network", recipes)
    # Six sections of four frames in three stretches of two.
    assert sorted(map(read.count, networks)) == [2, 2, 2]
    assert sorted(len(recipe.inputs["frames"]) for recipe in networks.values()) == [6, 8, 8]


def test_components_and_outlines_read_the_refined_foreground():
    recipes = _recipes(16, use="always")
    refined = _of("foreground", recipes, "video-network").keys()
    for task in ("components", "proposals"):
        assert all(set(recipe.inputs["foreground"]) <= refined for recipe in _of(task, recipes).values())


def test_the_weight_of_the_network_does_not_train_it_again():
    before, after = _recipes(16, use="always"), _recipes(16, use="always", weight=0.3)
    assert _of("video_network", before).keys() == _of("video_network", after).keys()
    assert not _of("components", before).keys() & _of("components", after).keys()


@pytest.fixture(scope="module")
def video(tmp_path_factory, write_squares):
    return write_squares(tmp_path_factory.mktemp("video") / "clip", num_frames=8) / "frames"


@pytest.fixture
def segment(moseg, video, tmp_path):
    """Return a function that segments the video with a small network and returns the outcome and the folder."""

    def call(name, *arguments):
        sets = [word for item in SMALL.items() for word in ("--set", "=".join(map(str, item)))]
        folder = tmp_path / name
        words = ("--store", folder / "store", "--out", folder / "out", "--proposals", "saliency")
        return moseg("segment", video, *words, "--quiet", *sets, *arguments), folder

    return call


def _digests(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in (folder / "out" / "masks").iterdir()}


def _weights(folder):
    """Return the trained weights by key."""
    store = open_store(str(folder / "store"))
    keys = (path.name for path in (folder / "store" / "objects" / "video_network").glob("*/*"))
    return {key: store.read(f"video_network/{key}", "weights").tobytes() for key in keys}


def test_masks_and_weights_are_the_same_with_one_and_two_workers(segment):
    pytest.importorskip("torch")
    (one, first), (two, second) = segment("one", "--workers", "1"), segment("two", "--workers", "2")
    assert one.code == 0 and two.code == 0, one.err + two.err
    assert _digests(first) == _digests(second)
    assert _weights(first) == _weights(second) and all(_weights(first).values())


def test_a_second_run_computes_nothing(segment):
    pytest.importorskip("torch")
    ran, _ = segment("again")
    assert ran.code == 0, ran.err
    again, _ = segment("again")
    assert again.code == 0 and "(0 artifacts computed" in again.out


def test_without_torch_it_ends_in_one_line_before_work(segment, monkeypatch):
    monkeypatch.setattr("moseg.workflows.stages.needed_packages.find_spec", lambda name: None)
    ran, folder = segment("without")
    assert ran.code == 2
    (line,) = ran.err.splitlines()
    assert "torch" in line and "pip install 'moseg[models]'" in line and "--set video_network.use=never" in line
    assert not list((folder / "out").rglob("*.png")) and not list((folder / "store").glob("objects/*/*/*"))
    never, _ = segment("without", "--set", "video_network.use=never")
    assert never.code == 0, never.err


def test_a_still_video_trains_nothing_and_keeps_its_foreground():
    from moseg.workflows.stages.foreground import VIDEO_NETWORK

    class Artifact:
        attributes = {"is_trained": False}

        def array(self, name):
            return np.full((2, 3, 4), 0.3, np.float16)

    config = PipelineConfig()
    inputs = {"foreground": Artifact(), "video_network": Artifact()}
    (output,) = VIDEO_NETWORK.compute(VIDEO_NETWORK.params(config), [inputs], [np.random.default_rng(0)])
    np.testing.assert_array_equal(output.arrays["foreground"], Artifact().array("foreground"))
