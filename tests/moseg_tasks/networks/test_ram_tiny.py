import io

import numpy as np
import pytest
import torch

from moseg.schemas.parameters.ram import RamParams
from moseg.tasks.networks import Checkpoint, unwrap_state
from moseg.tasks.networks.ram import build_ram, build_ram_plus
from moseg.tasks.tags import recognise_tags
from moseg.workflows.weights.tiny.ram import TAGS, make_ram, make_ram_plus

KINDS = [(make_ram, build_ram), (make_ram_plus, build_ram_plus)]


def tiny_tagger(make, build, seed=0):
    tiny = make(seed)
    content = torch.load(io.BytesIO(tiny.files["model.pth"]), weights_only=True)
    documents = {name: text.decode() for name, text in tiny.files.items() if name != "model.pth"}
    return build(Checkpoint("tiny", unwrap_state(content, "tiny"), documents, tiny.config))


@pytest.mark.parametrize(("make", "build"), KINDS)
def test_a_tiny_tagger_always_names_something_and_never_everything(make, build):
    for seed in range(3):
        tagger = tiny_tagger(make, build, seed)
        for image in np.random.default_rng(0).integers(0, 256, (3, 96, 128, 3), dtype=np.uint8):
            names = set(recognise_tags(tagger, image, RamParams()).names)
            assert set(TAGS[:4]) <= names <= set(TAGS[:8])


@pytest.mark.parametrize(("make", "build"), KINDS)
def test_a_tiny_tagger_looks_at_the_frame(make, build):
    tagger = tiny_tagger(make, build)
    scores = []
    for seed in range(4):
        blocks = np.random.default_rng(seed).integers(0, 256, (3, 4, 3), dtype=np.uint8)
        tags = recognise_tags(tagger, blocks.repeat(32, 0).repeat(32, 1), RamParams(threshold_scale=0))
        scores.append([dict(zip(*tags, strict=True))[name] for name in TAGS])
    assert np.std(scores, axis=0).mean() > 0.005


@pytest.mark.parametrize("make", [make_ram, make_ram_plus])
def test_a_seed_gives_the_same_small_files(make):
    tiny = make(3)
    assert tiny == make(3) != make(4)
    assert sum(len(content) for content in tiny.files.values()) < 200_000
