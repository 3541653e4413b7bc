"""A tiny random checkpoint of Depth Anything V2."""

import torch
from torch.nn import init
from transformers import DepthAnythingConfig, DepthAnythingForDepthEstimation, Dinov2Config

from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint, save_to_bytes
from moseg.workflows.weights.tiny.dpt_dinov2 import give_unit_gain

# Inverse depth about which the network's answers scatter.
_TYPICAL_INVERSE_DEPTH = 3.0


def make_depth_anything(seed: int) -> TinyCheckpoint:
    """Return the published network with few channels and two layers, as it processes even small frames at 518 px."""
    backbone = Dinov2Config(
        hidden_size=16,
        num_hidden_layers=2,
        num_attention_heads=1,
        mlp_ratio=2,
        image_size=70,
        patch_size=14,
        out_indices=[1, 2],
        reshape_hidden_states=False,
    )
    config = DepthAnythingConfig(
        backbone_config=backbone,
        reassemble_hidden_size=16,
        reassemble_factors=[2, 1],
        neck_hidden_sizes=[8, 8],
        fusion_hidden_size=8,
        head_hidden_size=4,
    )
    with torch.random.fork_rng(devices=()):
        torch.manual_seed(seed)
        model = DepthAnythingForDepthEstimation(config)
        give_unit_gain(model)
    init.constant_(model.head.conv3.bias, _TYPICAL_INVERSE_DEPTH)
    return TinyCheckpoint(save_to_bytes(model))
