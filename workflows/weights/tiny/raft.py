"""A tiny random checkpoint of RAFT, in torchvision's layout."""

import io

import torch

from moseg.tasks.networks.raft import LARGE, Raft, RaftConfig
from moseg.workflows.weights.tiny.checkpoint import TinyCheckpoint

_WIDTHS = {
    "stage_channels": (8, 12, 16),
    "feature_channels": 16,
    "hidden_channels": 16,
    "context_channels": 16,
    "correlation_radius": 2,
    "correlation_channels": (24, 16),
    "flow_channels": (12, 8),
    "motion_channels": 24,
    "head_channels": 24,
    "mask_channels": 16,
}
# Of the layer that gives the steps: keeps the flow of random weights at some pixels after twenty of them.
_STEP_LAYER, _STEP_GAIN = "update_block.flow_head.conv2.", 0.02


def make_raft(seed: int) -> TinyCheckpoint:
    """Return the large network at a fraction of its widths, with random weights: its flow depends on both images."""
    with torch.device("meta"):
        shapes = Raft(RaftConfig.model_validate(LARGE.model_dump() | _WIDTHS)).state_dict()
    generator = torch.Generator().manual_seed(seed)
    tensors = {key: _random_tensor(key, value, generator) for key, value in shapes.items()}
    stream = io.BytesIO()
    torch.save(tensors, stream)
    return TinyCheckpoint({"model.pth": stream.getvalue()}, dict(_WIDTHS))


def _random_tensor(key: str, like: torch.Tensor, generator: torch.Generator) -> torch.Tensor:
    """Return weights of unit gain under ReLU; biases and means near zero, variances and scales near one."""
    if not like.is_floating_point():
        return torch.zeros(like.shape, dtype=like.dtype)
    noise = torch.randn(like.shape, generator=generator) * (_STEP_GAIN if key.startswith(_STEP_LAYER) else 1)
    if like.ndim == 4:
        return noise * (2 / like[0].numel()) ** 0.5
    is_near_one = key.endswith(("running_var", ".1.weight"))
    return 1 + 0.1 * noise.clamp(-3, 3) if is_near_one else 0.05 * noise
