"""A tiny checkpoint of SAM 3 that finds rectangles at fixed places, others by each phrase, and keeps masks in place.

Its image encoder marks the cells of each rectangle in a channel, which its layers hand on almost unchanged to the
masks; each query of the detector outlines one of them. Its tracker is that of the tiny SAM 2.1.
"""

import json
import re
import string

import torch
from safetensors.torch import load, save
from transformers import Sam3VideoConfig, Sam3VideoModel
from transformers.models.sam3.modeling_sam3 import Sam3VisionNeck

from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint, save_to_bytes
from moseg.workflows.weights.tiny.sam2 import (
    GRID,
    MEMORY,
    WIDTH,
    look_up_masks,
    place_tokens,
    randomise,
    remember_masks,
    show_inside,
)

_WIDTH = 32
"""Channels of the detector; the tracker has those of the tiny SAM 2.1."""
_PATCH = 14
_SIDE = _PATCH * GRID
_RECTANGLES = ((0, 0, 3, 3), (0, 4, 2, 7), (3, 1, 6, 4), (4, 5, 7, 8), (6, 1, 8, 3), (2, 4, 4, 6))
"""Rows and columns of cells where each begins and ends."""
_CHANNEL = _WIDTH // 8
"""A channel for each, in a group of its own of those that are normalised together."""
_HIDDEN = 16
_HALF = 3.5
"""Of what the pixel decoder's normalisation makes of a marked cell."""
_WORDS = ("person", "car", "dog", "ball")
_RANDOM = re.compile(
    r"tracker_neck\..*proj2|output_hypernetworks_mlps.*(proj_in|layers)|pred_obj_score_head.*(proj_in|layers)"
)
"""Large weights of the tracker that stay as random as they are: eight bits are enough for them."""


def make_sam3(seed: int) -> TinyCheckpoint:
    """Return the published network, half precision, with half the channels, a layer or two of each kind and 112 px."""
    vocabulary, merges = _vocabulary()
    with torch.random.fork_rng(devices=()), torch.no_grad():
        torch.manual_seed(seed)
        model = Sam3VideoModel(_config(len(vocabulary))).eval()
        # transformers takes the detector's channels.
        model.tracker_neck = Sam3VisionNeck(model.config.tracker_config.vision_config)
        for name, tensor in model.state_dict().items():
            randomise(name, tensor)
        detector, tracker = model.detector_model, model.tracker_model
        _mark_rectangles(detector.vision_encoder)
        _outline_rectangles(detector.mask_decoder)
        _tell_queries_apart(detector)
        place_tokens(tracker, [layer.proj2 for layer in model.tracker_neck.fpn_layers])
        show_inside(tracker)
        remember_masks(tracker.memory_encoder)
        look_up_masks(tracker.memory_attention.layers[0].cross_attn_image)
    documents = {
        "vocab.json": json.dumps(vocabulary).encode(),
        "merges.txt": "".join(f"{line}\n" for line in ("#version: 0.2", *merges)).encode(),
    }
    files = save_to_bytes(model.half())
    # When it saves the whole network, transformers 5.23 puts the tracker's prefix in front of itself.
    doubled, prefix = "tracker_model.tracker_model.", "tracker_model."
    tensors = load(files["model.safetensors"])
    tensors = {prefix * name.startswith(doubled) + name.removeprefix(doubled): value for name, value in tensors.items()}
    tensors = {name: value.to(torch.float8_e5m2) if _RANDOM.search(name) else value for name, value in tensors.items()}
    return TinyCheckpoint(files | {"model.safetensors": save(tensors)} | documents)


def _config(num_tokens: int) -> Sam3VideoConfig:
    backbone = {
        "model_type": "sam3_vit_model",
        "hidden_size": _HIDDEN,
        "intermediate_size": 32,
        "num_hidden_layers": 2,
        "num_attention_heads": 2,
        "image_size": _SIDE,
        "pretrain_image_size": _SIDE,
        "patch_size": _PATCH,
        "window_size": 4,
        "global_attn_indexes": [1],
    }
    vision = {
        "model_type": "sam3_vision_model",
        "backbone_config": backbone,
        "backbone_feature_sizes": [[4 * GRID] * 2, [2 * GRID] * 2, [GRID] * 2],
        "fpn_hidden_size": _WIDTH,
    }
    small = {"hidden_size": _WIDTH, "num_attention_heads": 4, "intermediate_size": 16}
    text = {
        "model_type": "clip_text_model",
        "vocab_size": num_tokens,
        "hidden_size": _HIDDEN,
        "intermediate_size": 32,
        "projection_dim": 8,
        "num_hidden_layers": 1,
        "num_attention_heads": 2,
        "max_position_embeddings": 32,
        "bos_token_id": num_tokens - 2,
        "eos_token_id": num_tokens - 1,
        "pad_token_id": num_tokens - 1,
    }
    detector = {
        "model_type": "sam3",
        "vision_config": vision,
        "text_config": text,
        "geometry_encoder_config": {**small, "num_layers": 1, "roi_size": 2},
        "detr_encoder_config": {**small, "num_layers": 1},
        "detr_decoder_config": {**small, "num_layers": 1, "num_queries": len(_RECTANGLES)},
        "mask_decoder_config": {"hidden_size": _WIDTH, "num_attention_heads": 4, "num_upsampling_stages": 2},
    }
    tracker = {
        "model_type": "sam3_tracker_video",
        "vision_config": {**vision, "fpn_hidden_size": WIDTH},
        "prompt_encoder_config": {"hidden_size": WIDTH, "image_size": _SIDE, "mask_input_channels": 8},
        "mask_decoder_config": {
            "hidden_size": WIDTH,
            "mlp_dim": 16,
            "num_hidden_layers": 1,
            "num_attention_heads": 4,
            "attention_downsample_rate": 4,
            "iou_head_hidden_dim": 16,
        },
        "image_size": _SIDE,
        "memory_attention_hidden_size": WIDTH,
        "memory_attention_num_layers": 1,
        "memory_attention_downsample_rate": 2,
        "memory_attention_feed_forward_hidden_size": 16,
        "memory_attention_rope_feat_sizes": [GRID, GRID],
        "memory_encoder_hidden_size": WIDTH,
        "memory_encoder_output_channels": MEMORY,
        "mask_downsampler_embed_dim": WIDTH,
        "mask_downsampler_stride": 4,
        "mask_downsampler_kernel_size": 4,
        "mask_downsampler_padding": 0,
        "memory_fuser_num_layers": 1,
        "memory_fuser_embed_dim": WIDTH,
        "memory_fuser_intermediate_dim": 16,
    }
    return Sam3VideoConfig(detector_config=detector, tracker_config=tracker, low_res_mask_size=4 * GRID)


def _mark_rectangles(encoder: torch.nn.Module) -> None:
    """Mark the cells of each rectangle in a channel of the deepest features."""
    cells = torch.zeros(GRID, GRID, _HIDDEN)
    for index, (top, left, bottom, right) in enumerate(_RECTANGLES):
        cells[top:bottom, left:right, index] = 4
    encoder.backbone.embeddings.position_embeddings[0] = cells.flatten(0, 1)
    for layer in encoder.backbone.layers:
        layer.attention.o_proj.weight /= 10
        layer.mlp.fc2.weight /= 10
    deepest = encoder.neck.fpn_layers[2]
    for index in range(len(_RECTANGLES)):
        deepest.proj1.weight[index * _CHANNEL, index] = 1
        deepest.proj2.weight[index * _CHANNEL, index * _CHANNEL, 1, 1] = 1


def _outline_rectangles(decoder: torch.nn.Module) -> None:
    """Hand the channels of the rectangles on to the masks, with a logit of 0 halfway from outside to inside."""
    chosen = torch.arange(len(_RECTANGLES)) * _CHANNEL
    for convolution in decoder.pixel_decoder.conv_layers:
        convolution.weight[chosen, chosen, 1, 1] = 1
    decoder.instance_projection.weight.zero_()
    decoder.instance_projection.weight[chosen, chosen, 0, 0] = 1
    decoder.instance_projection.bias[chosen] = -_HALF
    for layer in decoder.mask_embedder.layers:
        layer.weight.copy_(torch.eye(_WIDTH))


def _tell_queries_apart(detector: torch.nn.Module) -> None:
    """Give each query the channel of its rectangle; some queries match a phrase, and a phrase is always shown."""
    decoder, scoring = detector.detr_decoder, detector.dot_product_scoring
    decoder.query_embed.weight.zero_()
    for index in range(len(_RECTANGLES)):
        decoder.query_embed.weight[index, index * _CHANNEL] = 4
    decoder.presence_head.layer3.bias.fill_(10)
    detector.text_encoder.text_model.embeddings.token_embedding.weight.normal_()
    detector.text_projection.weight.normal_()
    for projection in (scoring.text_proj, scoring.query_proj):
        projection.weight.normal_(std=2 * _WIDTH**-0.5)


def _vocabulary() -> tuple[dict[str, int], list[str]]:
    """Return the tokens of letters and of a few words with their numbers, and the pairs that make up these words."""
    signs = [sign for sign in string.printable[:94] if sign not in string.ascii_uppercase]
    tokens, merges = [*signs, *(f"{sign}</w>" for sign in signs)], []
    for word in _WORDS:
        pieces = [*word[:-1], f"{word[-1]}</w>"]
        made = pieces[0]
        for piece in pieces[1:]:
            if f"{made} {piece}" not in merges:
                merges.append(f"{made} {piece}")
                tokens.append(made + piece)
            made += piece
    tokens += ["<|startoftext|>", "<|endoftext|>"]
    return {token: number for number, token in enumerate(tokens)}, merges
