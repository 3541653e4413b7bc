"""A tiny Grounding DINO that finds a few boxes in any image."""

import json
import string

import torch
from transformers import GroundingDinoConfig, GroundingDinoForObjectDetection

from moseg.tasks.networks.grounding_dino.build import SPECIAL_TOKENS
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint, save_to_bytes

_WIDTH = 32
_NUM_QUERIES = 10
_WORDS = ("person", "man", "woman", "car", "bus", "dog", "cat", "horse", "bird", "ball", "tree", "road", "sky")
# Boxes sit where their queries say: deviation of a centre and of a side, in logits of their share of the frame.
_SPREAD = (0.8, 0.8, 0.3, 0.3)
_LARGER = 2.0
# A word's logit is the dot product of a query and the word. Both end in a layer norm, whose zero-mean part gives the
# spread of the logits and whose bias, along the ones, the mean: under the box threshold, over it for the best words.
_NORM_WEIGHT = 0.6
_MEAN_LOGIT = -1.0


def make_grounding_dino(seed: int) -> TinyCheckpoint:
    """Return files of ``IDEA-Research/grounding-dino-tiny``, random except for biases towards a handful of boxes."""
    vocabulary = _vocabulary()
    config = GroundingDinoConfig(
        backbone_config={
            "model_type": "swin",
            "image_size": 32,
            "embed_dim": 8,
            "depths": [1, 1, 1, 1],
            "num_heads": [1, 1, 2, 2],
            "window_size": 4,
            "out_indices": [2, 3, 4],
        },
        text_config={
            "model_type": "bert",
            "vocab_size": len(vocabulary),
            "hidden_size": _WIDTH,
            "num_hidden_layers": 1,
            "num_attention_heads": 2,
            "intermediate_size": _WIDTH,
            "max_position_embeddings": 256,
        },
        d_model=_WIDTH,
        num_queries=_NUM_QUERIES,
        encoder_layers=1,
        decoder_layers=2,
        encoder_ffn_dim=64,
        decoder_ffn_dim=64,
        encoder_attention_heads=4,
        decoder_attention_heads=4,
        encoder_n_points=2,
        decoder_n_points=2,
    )
    with torch.random.fork_rng(devices=[]), torch.no_grad():
        torch.manual_seed(seed)
        model = GroundingDinoForObjectDetection(config)
        _bias(model)
    preprocessor = {
        "image_processor_type": "GroundingDinoImageProcessor",
        "size": {"shortest_edge": 96, "longest_edge": 160},
    }
    documents = {
        "preprocessor_config.json": json.dumps(preprocessor, indent=2).encode(),
        "vocab.txt": "".join(f"{token}\n" for token in vocabulary).encode(),
    }
    return TinyCheckpoint(save_to_bytes(model) | documents)


def _bias(model: GroundingDinoForObjectDetection) -> None:
    """Set biases so that queries differ, boxes follow their queries, and some words match some queries."""
    core = model.model
    core.query_position_embeddings.weight.normal_()
    core.encoder_output_bbox_embed.layers[-1].bias[2:] = _LARGER
    *hidden, last = model.bbox_embed[0].layers
    for layer in hidden:
        layer.weight.normal_(std=(2 / _WIDTH) ** 0.5)
    last.weight.normal_(std=_WIDTH**-0.5).mul_(torch.tensor(_SPREAD)[:, None])
    mean = abs(_MEAN_LOGIT / _WIDTH) ** 0.5
    for norm, sign in (
        (core.encoder.layers[-1].text_enhancer_layer.layer_norm_after, -1),
        (core.decoder.layer_norm, 1),
    ):
        norm.weight.fill_(_NORM_WEIGHT)
        norm.bias.fill_(sign * mean)


def _vocabulary() -> list[str]:
    """Return a few words, and letters that make up all others; special tokens have BERT's numbers."""
    letters = string.ascii_lowercase + string.digits
    signs = sorted(set(string.punctuation) - set(SPECIAL_TOKENS))
    tokens = {0: "[PAD]", 100: "[UNK]", 103: "[MASK]", **{number: token for token, number in SPECIAL_TOKENS.items()}}
    words = [*letters, *(f"##{letter}" for letter in letters), *_WORDS, *signs]
    tokens |= dict(enumerate(words, start=200))
    return [tokens.get(number, f"[unused{number}]") for number in range(max(tokens) + 1)]
