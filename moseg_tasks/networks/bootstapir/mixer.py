"""The mixer that updates a point's positions and appearances in all frames of a section."""

import torch
import torch.nn.functional as F
from torch import nn

from moseg.tasks.networks.bootstapir.config import BootsTapirConfig

EXPANSION = 4
"""Hidden channels of a mixing layer, as a multiple of its input channels."""
WIDTH = 3
"""Frames that a convolution over time spans."""


class Mixer(nn.Module):
    """PIPs' mixer with convolutions over time in place of layers over a fixed number of frames."""

    def __init__(self, config: BootsTapirConfig):
        super().__init__()
        outputs = 4 + config.fine + config.coarse
        self.linear = nn.Linear(outputs + config.num_correlations, config.hidden)
        self.blocks = nn.ModuleList(_Block(config.hidden) for _ in range(config.depth))
        self.layer_norm = nn.LayerNorm(config.hidden, bias=False)
        self.linear_1 = nn.Linear(config.hidden, outputs)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        """Map (N, S, inputs) to corrections (N, S, 4 + channels of an appearance)."""
        x = self.linear(x)
        for block in self.blocks:
            x = block(x)
        return self.linear_1(self.layer_norm(x))


class _Block(nn.Module):
    """Mixing of frames, each channel for itself, then of channels, each frame for itself."""

    def __init__(self, channels: int):
        super().__init__()
        inside = EXPANSION * channels
        self.layer_norm = nn.LayerNorm(channels, bias=False)
        self.mlp1_up = nn.Conv1d(channels, inside, WIDTH, padding=WIDTH // 2, groups=channels)
        self.mlp1_up_1 = nn.Conv1d(inside, inside, WIDTH, padding=WIDTH // 2, groups=inside)
        self.layer_norm_1 = nn.LayerNorm(channels, bias=False)
        self.conv_channels_mixer = _ChannelMixing(channels)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        x = x + self._mix_frames(self.layer_norm(x))
        return x + self.conv_channels_mixer(self.layer_norm_1(x))

    def _mix_frames(self, x: torch.Tensor) -> torch.Tensor:
        hidden = F.gelu(self.mlp1_up(x.transpose(1, 2)), approximate="tanh")
        # The hidden channels of a channel are convolved each for itself and then summed: one convolution of all.
        weight = self.mlp1_up_1.weight.view(-1, EXPANSION, WIDTH)
        bias = self.mlp1_up_1.bias.view(-1, EXPANSION).sum(dim=1)
        return F.conv1d(hidden, weight, bias, padding=WIDTH // 2, groups=len(weight)).transpose(1, 2)


class _ChannelMixing(nn.Module):
    """Two layers over channels."""

    def __init__(self, channels: int):
        super().__init__()
        self.mlp2_up = nn.Linear(channels, EXPANSION * channels)
        self.mlp2_down = nn.Linear(EXPANSION * channels, channels)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return self.mlp2_down(F.gelu(self.mlp2_up(x), approximate="tanh"))
