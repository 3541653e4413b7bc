"""A tiny random checkpoint of SEA-RAFT, in the layout of the hub's files."""

import re

import torch
from safetensors.torch import save

from moseg.tasks.networks.sea_raft import SMALL, SeaRaft, SeaRaftConfig
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

_WIDTHS = {"stage_channels": (8, 12, 16), "hidden_channels": 16, "correlation_radius": 2}
# Of the layers that give the steps and the recurrent state: keep the flow of random weights at some pixels.
_GAINS = {"flow_head.2.": 0.1, ".final.": 0.3, ".convnormrelu2.": 0.3}
_RULES = (
    (r"^context_encoder\.", "cnet."),
    (r"^feature_encoder\.", "fnet."),
    (r"^([cf]net\.)conv\.", r"\1final_conv."),
    (r"convnormrelu\.0\.", "conv1."),
    (r"convnormrelu\.1\.", "bn1."),
    (r"convnormrelu(\d)\.0\.", r"conv\1."),
    (r"convnormrelu(\d)\.1\.", r"bn\1."),
    (r"downsample\.1\.", "bn3."),
    (r"conv(corr|flow)(\d)\.0\.", lambda match: f"conv{match[1][0]}{match[2]}."),
    (r"(update_block\.encoder\.conv)\.0\.", r"\1."),
    (r"^mask_predictor\.convrelu\.0\.", "upsample_weight.0."),
    (r"^mask_predictor\.conv\.", "upsample_weight.2."),
)


def make_sea_raft(seed: int) -> TinyCheckpoint:
    """Return the small network at a fraction of its widths, with random weights: its flow depends on both images."""
    with torch.device("meta"):
        shapes = SeaRaft(SeaRaftConfig.model_validate(SMALL.model_dump() | _WIDTHS)).state_dict()
    generator = torch.Generator().manual_seed(seed)
    tensors = {to_published_name(key): _random_tensor(key, value, generator) for key, value in shapes.items()}
    return TinyCheckpoint({"model.safetensors": save(tensors)}, dict(_WIDTHS))


def to_published_name(key: str) -> str:
    """Return the authors' name of a tensor of our module: of the two of a shortcut's normalisation, the hub's."""
    published = key
    for pattern, replacement in _RULES:
        published = re.sub(pattern, replacement, published)
    return published


def _random_tensor(key: str, like: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    """Return weights of unit gain under ReLU; biases and means near zero, variances and scales near one."""
    if not like.is_floating_point():
        return torch.zeros(like.shape, dtype=like.dtype)
    noise = torch.randn(like.shape, generator=generator)
    if like.ndim > 1:
        gain = next((gain for part, gain in _GAINS.items() if part in key), 1.0)
        return gain * noise * (2 / like[0].numel()) ** 0.5
    is_near_one = key.endswith(("running_var", ".1.weight", "norm.weight", "gamma"))
    return 1 + 0.1 * noise.clamp(-3, 3) if is_near_one else 0.05 * noise
