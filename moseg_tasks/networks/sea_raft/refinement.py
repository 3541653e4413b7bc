"""The recurrent part of SEA-RAFT: RAFT's motion encoder, and ConvNeXt blocks in place of its recurrent units."""

import torch
from torch import Tensor, nn

from moseg.tasks.networks.raft.update import MotionEncoder
from moseg.tasks.networks.sea_raft.config import SeaRaftConfig

_EXPANSION = 4
_EPSILON = 1e-6


class UpdateBlock(nn.Module):
    """One iteration: the recurrent state, refined by context and motion.

    References
    ----------
    Wang, Lipson, Deng, ECCV 2024, section 3.3.
    """

    def __init__(self, config: SeaRaftConfig):
        super().__init__()
        hidden = config.hidden_channels
        self.encoder = MotionEncoder(config.motion_encoder())
        self.refine = nn.ModuleList(ConvNextBlock(3 * hidden, hidden) for _ in range(config.num_refinements))

    def forward(self, hidden: Tensor, context: Tensor, correlations: Tensor, flow: Tensor) -> Tensor:
        """Advance the recurrent state (B, channels, h, w); the flow is in cells."""
        inputs = torch.cat([context, self.encoder(flow, correlations)], dim=1)
        for block in self.refine:
            hidden = block(torch.cat([hidden, inputs], dim=1))
        return hidden


class ConvNextBlock(nn.Module):
    """A depthwise 7x7 convolution and a perceptron of each cell, around which the input is added; then a projection.

    References
    ----------
    Liu et al., "A ConvNet for the 2020s", CVPR 2022.
    """

    def __init__(self, in_channels: int, out_channels: int):
        super().__init__()
        inner = _EXPANSION * out_channels
        self.dwconv = nn.Conv2d(in_channels, in_channels, 7, padding=3, groups=in_channels)
        self.norm = nn.LayerNorm(in_channels, eps=_EPSILON)
        self.pwconv1 = nn.Linear(in_channels, inner)
        self.pwconv2 = nn.Linear(inner, in_channels)
        self.gamma = nn.Parameter(torch.ones(in_channels))
        self.final = nn.Conv2d(in_channels, out_channels, 1)

    def forward(self, x: Tensor) -> Tensor:
        cells = self.norm(self.dwconv(x).permute(0, 2, 3, 1))
        cells = self.gamma * self.pwconv2(nn.functional.gelu(self.pwconv1(cells)))
        return self.final(x + cells.permute(0, 3, 1, 2))
