import hashlib

import numpy as np
import pytest
import torch

from moseg.schemas.errors import InputError
from moseg.tasks.networks import Checkpoint
from moseg.tasks.networks.ram import Ram, RamConfig, RamPlus, build_ram, build_ram_plus

# Of the sorted lines "name shape", computed with the official modules, without captioner and derived buffers.
PUBLISHED = {
    Ram: (366, 212117045, "9892e72b4a033ef15d2aabffacf4f970adda0068c5e3d6761df1716bb398d493"),
    RamPlus: (367, 329493046, "27c933add6fcec34034b6b8ab27491510fa1dfc5215fbb9f8f680700e76a105b"),
}
SIZES = {
    "image": {"image_size": 16, "embed_dim": 4, "depths": [1, 1], "num_heads": [1, 2], "window_size": 2},
    "num_tags": 3,
    "num_descriptions": 2,
    "embedding_width": 4,
    "width": 6,
    "num_heads": 2,
    "hidden": 8,
    "num_layers": 1,
}
DOCUMENTS = {"tags.txt": "person\ntoy car\ndog", "thresholds.txt": "0.65\n0.8\n0.65\n"}


def ram_tensors():
    """Each with a value of its own."""
    with torch.device("meta"):
        shapes = Ram(RamConfig.model_validate(SIZES)).state_dict()
    return {name: torch.full(tensor.shape, float(k)) for k, (name, tensor) in enumerate(shapes.items())}


def plus_tensors():
    return ram_tensors() | {"label_embed": torch.full((6, 4), 0.5)}


def assemble(build, tensors, documents=DOCUMENTS, sizes=SIZES):
    return build(Checkpoint("tiny", tensors, documents, sizes))


@pytest.mark.parametrize("kind", PUBLISHED)
def test_the_state_dict_is_the_published_one(kind):
    with torch.device("meta"):
        tensors = kind(RamConfig()).state_dict()
    lines = sorted(f"{key} {tuple(value.shape)}" for key, value in tensors.items())
    digest = hashlib.sha256("\n".join(lines).encode()).hexdigest()
    assert (len(tensors), sum(value.numel() for value in tensors.values()), digest) == PUBLISHED[kind]


@pytest.mark.parametrize(("build", "make"), [(build_ram, ram_tensors), (build_ram_plus, plus_tensors)])
def test_a_tagger_has_the_checkpoints_weights_and_tags(build, make):
    tensors = make()
    tagger = assemble(build, tensors).to("cpu")
    state = tagger.network.state_dict()
    assert all(torch.equal(state[name], tensor) for name, tensor in tensors.items())
    assert not tagger.network.training and not any(weight.requires_grad for weight in tagger.network.parameters())
    assert tagger.names == ("person", "toy car", "dog")
    np.testing.assert_array_equal(tagger.thresholds, [0.65, 0.8, 0.65])


def test_ram_plus_without_a_scale_uses_clips_initial_scale():
    scale = assemble(build_ram_plus, plus_tensors()).network.reweight_scale.exp()
    assert float(scale) == pytest.approx(1 / 0.07, rel=1e-6)
    given = assemble(build_ram_plus, plus_tensors() | {"reweight_scale": torch.tensor(1.5)})
    assert float(given.network.reweight_scale) == 1.5


def test_tensors_for_training_only_are_dropped():
    beside = {
        "text_decoder.cls.predictions.bias": torch.zeros(2),
        "tag_encoder.embeddings.position_ids": torch.zeros(1, 2, dtype=torch.int64),
        "visual_encoder.layers.0.blocks.0.attn.relative_position_index": torch.zeros(4, 4, dtype=torch.int64),
        "visual_encoder.layers.0.blocks.1.attn_mask": torch.zeros(4, 4, 4),
        "logit_scale": torch.zeros(()),
    }
    assemble(build_ram, ram_tensors() | beside)


def test_the_heads_old_name_is_understood():
    tensors = ram_tensors()
    renamed = {name.replace("tagging_head.", "vision_multi."): tensor for name, tensor in tensors.items()}
    assert renamed.keys() != tensors.keys()
    state = assemble(build_ram, renamed).network.state_dict()
    assert all(torch.equal(state[name], tensor) for name, tensor in tensors.items())


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"fc.bias": None}, "missing.*fc.bias"),
        ({"visual_encoder.head.weight": torch.zeros(2)}, "not the network's.*head.weight"),
        ({"tagging_head.embeddings.word_embeddings.weight": torch.zeros(2)}, "not the network's"),
        ({"label_embed": torch.zeros(6, 4)}, "another shape.*label_embed"),
    ],
)
def test_tensors_of_another_network_are_refused(change, message):
    tensors = {name: tensor for name, tensor in (ram_tensors() | change).items() if tensor is not None}
    with pytest.raises(InputError, match=message):
        assemble(build_ram, tensors)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tags.txt": "person\ncar"}, "number of lines.*tags.txt.*got 2.*expected 3"),
        ({"tags.txt": "person\n\ndog"}, "empty or repeated"),
        ({"tags.txt": "person\ndog\ndog"}, "empty or repeated"),
        ({"thresholds.txt": "0.5\n0.5\n"}, "number of lines.*thresholds.txt"),
        ({"thresholds.txt": "0.5\nhigh\n0.5"}, "not a number.*high"),
        ({"thresholds.txt": "0.5\n1.5\n0.5"}, "outside"),
        ({"thresholds.txt": "0.5\nnan\n0.5"}, "outside"),
    ],
)
def test_lists_that_do_not_fit_are_refused(change, message):
    with pytest.raises(InputError, match=message):
        assemble(build_ram, ram_tensors(), DOCUMENTS | change)


@pytest.mark.parametrize("document", DOCUMENTS)
def test_a_missing_list_is_named(document):
    with pytest.raises(InputError, match=document):
        assemble(build_ram, ram_tensors(), {name: text for name, text in DOCUMENTS.items() if name != document})


@pytest.mark.parametrize("change", [{"width": 7}, {"height": 3}, {"image": {"image_size": 15}}])
def test_sizes_of_no_network_are_refused(change):
    with pytest.raises(InputError, match="invalid sizes in config of weights tiny"):
        assemble(build_ram, ram_tensors(), sizes=SIZES | change)
