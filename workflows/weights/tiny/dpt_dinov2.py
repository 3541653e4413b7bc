"""A tiny random checkpoint of DINOv2 with a DPT head."""

import io

import torch
from safetensors.torch import load
from torch.nn import init
from transformers import Dinov2Config, DPTConfig, DPTForDepthEstimation, PreTrainedModel

from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint, save_to_bytes

# Depth around which the network's answers scatter, m.
_TYPICAL_DEPTH = 3.0


def make_dpt_dinov2(seed: int) -> TinyCheckpoint:
    """Return the published network with few channels and four layers, and depths of a few metres.

    It has no projection before the heads (`add_projection`), unlike the published one: transformers fixes its 256
    channels, and with them those of the whole neck, 38 MB in all.
    """
    backbone = Dinov2Config(
        hidden_size=16,
        num_hidden_layers=4,
        num_attention_heads=2,
        mlp_ratio=2,
        image_size=70,
        patch_size=14,
        out_indices=[1, 2, 3, 4],
        reshape_hidden_states=False,
        apply_layernorm=False,
    )
    config = DPTConfig(
        backbone_config=backbone,
        neck_hidden_sizes=[8, 8, 8, 8],
        fusion_hidden_size=16,
        use_bias_in_fusion_residual=False,
        add_projection=False,
    )
    with torch.random.fork_rng(devices=()):
        torch.manual_seed(seed)
        model = DPTForDepthEstimation(config)
        give_unit_gain(model)
    init.constant_(model.head.head[4].bias, _TYPICAL_DEPTH)
    files = save_to_bytes(model)
    # The published ones are older than safetensors.
    stream = io.BytesIO()
    torch.save(load(files["model.safetensors"]), stream)
    depths = {"min_depth": 0.001, "max_depth": 10.0}
    return TinyCheckpoint({"config.json": files["config.json"], "model.bin": stream.getvalue()}, depths)


def give_unit_gain(model: PreTrainedModel) -> None:
    """Draw weights anew so that a layer's output is about as large as its input; without biases.

    With the small weights with which training starts, a random network's output is the same everywhere.
    """
    for name, tensor in model.state_dict().items():
        if tensor.ndim > 1:
            init.normal_(tensor, std=tensor[0].numel() ** -0.5)
        elif name.endswith("bias"):
            init.zeros_(tensor)
        else:
            init.ones_(tensor)
