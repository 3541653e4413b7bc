import hashlib
import json

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from transformers import GroundingDinoConfig, GroundingDinoForObjectDetection

from moseg.schemas.errors import InputError
from moseg.tasks.networks.grounding_dino import build_grounding_dino, compose_prompts

# Of a network that agreed with the authors' code at a larger size: logits to 3e-4 of 6.6, boxes to 1e-6.
BOXES = [[0.02241374, 0.76484888, 0.08950461, 0.20601495], [0.03767552, 0.40874618, 0.10301681, 0.07459364]]
LOGITS = [[-4.60186338, 2.98098826, 4.80706167], [-0.4067151, 2.50491953, 9.09627724]]
# IDEA-Research/grounding-dino-tiny, tensors as named by transformers 5.
DIGEST = "b8e4700f9440c8d9"


def test_names_and_shapes_are_the_published_ones():
    with torch.device("meta"):
        model = GroundingDinoForObjectDetection(GroundingDinoConfig())
    state = model.state_dict()
    listed = "\n".join(sorted(f"{name} {tuple(value.shape)}" for name, value in state.items()))
    assert len(state) == 1046
    # In single precision they fill the 689 MB of the published file.
    assert sum(value.numel() for value in model.parameters()) == 172_250_626
    assert hashlib.sha256(listed.encode()).hexdigest()[:16] == DIGEST


def test_tensors_of_the_published_naming_are_read(grounding_dino_checkpoint):
    name = "model.backbone.conv_encoder.model.encoder.layers.0.blocks.0.attention.self.query.weight"
    index = name.replace("query.weight", "relative_position_index")
    assert name in grounding_dino_checkpoint.tensors
    # A buffer that the published files have and the network computes itself.
    tensors = {**grounding_dino_checkpoint.tensors, index: torch.zeros(16, 16, dtype=torch.long)}
    model = build_grounding_dino(grounding_dino_checkpoint._replace(tensors=tensors)).model
    block = model.model.backbone.conv_encoder.model.swin.encoder.layers[0].blocks[0]
    assert torch.equal(block.attention.q_proj.weight, tensors[name])


def test_the_heads_of_all_decoder_layers_are_one(detector):
    first = detector.model.bbox_embed[0].layers[0].weight
    assert first.abs().sum() > 0
    assert torch.equal(first, detector.model.model.decoder.bbox_embed[1].layers[0].weight)


def test_a_missing_tensor_is_named(grounding_dino_checkpoint):
    tensors = dict(grounding_dino_checkpoint.tensors)
    del tensors["model.level_embed"]
    with pytest.raises(InputError, match=r"tensors are missing in weights tiny; got model\.level_embed"):
        build_grounding_dino(grounding_dino_checkpoint._replace(tensors=tensors))


@torch.inference_mode()
def test_random_weights_give_the_golden_boxes(grounding_dino_checkpoint, with_unit_gain):
    detector = build_grounding_dino(with_unit_gain(grounding_dino_checkpoint))
    generator = torch.Generator().manual_seed(0)
    pixels = torch.randn(1, 3, 96, 128, generator=generator, dtype=torch.float64)
    (prompt,) = compose_prompts(detector.tokenizer, ["a dog", "tennis ball"], 40, 256, "stop")
    output = detector.model.double()(pixel_values=pixels, input_ids=torch.tensor([prompt.token_ids]))
    # Places are encoded in float32.
    torch.testing.assert_close(output.pred_boxes[0, :2], torch.tensor(BOXES, dtype=torch.float64), atol=1e-4, rtol=0)
    torch.testing.assert_close(output.logits[0, :2, 1:4], torch.tensor(LOGITS), atol=1e-3, rtol=0)


@pytest.mark.parametrize(
    ("documents", "message"),
    [
        ({"vocab.txt": None}, r"no vocab\.txt"),
        ({"vocab.txt": "[PAD]\nperson\n"}, "not BERT's vocabulary"),
        ({"preprocessor_config.json": "{}"}, "no input size"),
        ({"preprocessor_config.json": json.dumps({"size": 800})}, "no input size"),
        ({"preprocessor_config.json": None}, r"no preprocessor_config\.json"),
    ],
)
def test_documents_that_do_not_fit_are_named(grounding_dino_checkpoint, documents, message):
    documents = {**grounding_dino_checkpoint.documents, **documents}
    documents = {name: text for name, text in documents.items() if text is not None}
    with pytest.raises(InputError, match=message):
        build_grounding_dino(grounding_dino_checkpoint._replace(documents=documents))


def test_a_vocabulary_larger_than_the_networks_is_refused(grounding_dino_checkpoint):
    longer = grounding_dino_checkpoint.documents["vocab.txt"] + "zebra\n"
    documents = {**grounding_dino_checkpoint.documents, "vocab.txt": longer}
    with pytest.raises(InputError, match="more tokens than the network has"):
        build_grounding_dino(grounding_dino_checkpoint._replace(documents=documents))


def authors_size(width, height, shorter, longer):
    """The rule of their ``get_size_with_aspect_ratio``, on (width, height): height and width."""
    low, high = float(min(width, height)), float(max(width, height))
    if high / low * shorter > longer:
        shorter = round(longer * low / high)
    if min(width, height) == shorter:
        return height, width
    if width < height:
        return int(shorter * height / width), shorter
    return shorter, int(shorter * width / height)


def test_input_sizes_are_those_of_the_authors(detector):
    published = detector._replace(shorter_side=800, longer_side=1333)
    sides = [*range(20, 1000, 23), 480, 720, 800, 854, 1080, 1242, 1333, 1920, 2160, 3840]
    for height in sides:
        for width in sides:
            assert published.input_size(height, width, 1.0) == authors_size(width, height, 800, 1333), (height, width)


@given(st.integers(16, 4000), st.integers(16, 4000))
def test_input_sizes_stay_near_the_published_sides(detector, height, width):
    size = detector._replace(shorter_side=800, longer_side=1333).input_size(height, width, 1.0)
    # The shorter side is rounded, and the longer follows it.
    slack = 0.5 * max(height, width) / min(height, width) + 1
    assert min(size) <= 800 and max(size) <= 1333 + slack
    assert min(size) == 800 or max(size) >= 1333 - slack


@pytest.mark.parametrize(
    ("size", "input_scale", "expected"),
    [((480, 854), 1.0, (749, 1332)), ((480, 640), 1.0, (800, 1066)), ((480, 640), 0.5, (400, 533))],
)
def test_the_published_input_can_be_scaled(detector, size, input_scale, expected):
    published = detector._replace(shorter_side=800, longer_side=1333)
    assert published.input_size(*size, input_scale) == expected
