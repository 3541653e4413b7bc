"""The motion network that comes with the program, and others in its place."""

import hashlib
import json

import numpy as np
import pytest

from moseg.schemas.configs import PipelineConfig
from moseg.schemas.errors import InputError
from moseg.tasks.motion_network import motion_network_logit, read_network
from moseg.tasks.motion_network.samples import draw_sample
from moseg.tasks.training_scenes import paint_textures
from moseg.workflows.sources import MotionWeights
from moseg.workflows.stages.motion_network import uses_motion_network

UNSEEN = 4711  # a seed of which nothing was trained on


@pytest.fixture(scope="module")
def shipped() -> bytes:
    return MotionWeights("").read().tobytes()


def test_the_network_is_small_and_the_one_of_its_recipe(shipped):
    from importlib.resources import files

    recipe = json.loads((files("moseg.workflows.weights") / "motion_network.json").read_text())
    assert len(shipped) == recipe["result"]["bytes"] <= 6_000_000
    assert hashlib.sha256(shipped).hexdigest() == recipe["result"]["sha256"]
    assert recipe["licence"] == "MIT"


def test_the_network_finds_what_moves_in_scenes_that_it_has_not_seen(shipped):
    network, textures = read_network(shipped), paint_textures(UNSEEN, 16)
    found = []
    for index in range(12):
        sample = draw_sample(UNSEEN, index, (240, 427), textures)
        moves = motion_network_logit(network, sample.channels) > 0
        true = (sample.label > 127) & sample.counts
        if true.sum() > 100:
            found.append((moves & true).sum() / (((moves & sample.counts) | true).sum()))
    assert len(found) > 5 and np.mean(found) > 0.4


def test_the_fingerprint_follows_the_bytes_of_the_file(shipped, tmp_path):
    (tmp_path / "a.onnx").write_bytes(shipped)
    (tmp_path / "b.onnx").write_bytes(shipped + b"\0")
    same, other = (MotionWeights(str(tmp_path / name)).fingerprint() for name in ("a.onnx", "b.onnx"))
    assert same == MotionWeights("").fingerprint() != other


@pytest.mark.parametrize("content", [b"", b"no network"])
def test_a_file_that_is_no_network_is_named(tmp_path, content):
    path = tmp_path / "mine.onnx"
    path.write_bytes(content)
    with pytest.raises(InputError, match="not a motion network") as caught:
        MotionWeights(str(path)).read()
    assert str(path) in str(caught.value)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match="file does not exist"):
        MotionWeights(str(tmp_path / "none.onnx")).fingerprint()


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({}, True),
        ({"proposal_source": "saliency"}, True),
        ({"proposal_source": "tracks"}, False),
        ({"motion_network": {"use": "never"}}, False),
    ],
)
def test_the_network_looks_where_saliency_does(changes, expected):
    assert uses_motion_network(PipelineConfig.model_validate(changes)) is expected
