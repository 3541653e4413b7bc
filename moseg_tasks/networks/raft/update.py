"""RAFT's update block: from correlations around the current flow to an update of the flow."""

import torch
from torch import Tensor, nn

from moseg.tasks.networks.raft.config import RaftConfig
from moseg.tasks.networks.raft.convolution import conv_norm_relu


class UpdateBlock(nn.Module):
    """Motion features, recurrent units and flow head: one iteration.

    References
    ----------
    Teed, Deng, ECCV 2020, section 3.3.
    """

    def __init__(self, config: RaftConfig):
        super().__init__()
        inputs = config.context_channels + config.motion_channels
        self.motion_encoder = MotionEncoder(config)
        self.recurrent_block = RecurrentBlock(inputs, config.hidden_channels, config.gru_kernels)
        self.flow_head = FlowHead(config.hidden_channels, config.head_channels)

    def forward(self, hidden: Tensor, context: Tensor, correlations: Tensor, flow: Tensor) -> tuple[Tensor, Tensor]:
        """Advance the recurrent state; return it and the update of the flow, (B, 2, h, w) in cells."""
        motion = self.motion_encoder(flow, correlations)
        hidden = self.recurrent_block(hidden, torch.cat([context, motion], dim=1))
        return hidden, self.flow_head(hidden)


class MotionEncoder(nn.Module):
    """Features of the current flow and of the correlations around it; the last two channels are the flow itself."""

    def __init__(self, config: RaftConfig):
        super().__init__()
        looked_up = config.correlation_levels * (2 * config.correlation_radius + 1) ** 2
        first, last = config.correlation_channels[0], config.correlation_channels[-1]
        has_second = len(config.correlation_channels) == 2
        self.convcorr1 = conv_norm_relu(looked_up, first, 1)
        self.convcorr2 = conv_norm_relu(first, last, 3) if has_second else nn.Identity()
        self.convflow1 = conv_norm_relu(2, config.flow_channels[0], 7)
        self.convflow2 = conv_norm_relu(*config.flow_channels, 3)
        self.conv = conv_norm_relu(last + config.flow_channels[1], config.motion_channels - 2, 3)

    def forward(self, flow: Tensor, correlations: Tensor) -> Tensor:
        correlations = self.convcorr2(self.convcorr1(correlations))
        both = torch.cat([correlations, self.convflow2(self.convflow1(flow))], dim=1)
        return torch.cat([self.conv(both), flow], dim=1)


class RecurrentBlock(nn.Module):
    """One recurrent unit with a square kernel, or a horizontal and a vertical one in sequence."""

    def __init__(self, in_channels: int, hidden_channels: int, kernels: tuple[tuple[int, int], ...]):
        super().__init__()
        self.convgru1 = ConvGru(in_channels, hidden_channels, kernels[0])
        self.convgru2 = ConvGru(in_channels, hidden_channels, kernels[1]) if len(kernels) == 2 else None

    def forward(self, hidden: Tensor, x: Tensor) -> Tensor:
        hidden = self.convgru1(hidden, x)
        return hidden if self.convgru2 is None else self.convgru2(hidden, x)


class ConvGru(nn.Module):
    """Gated recurrent unit whose gates are convolutions (equations 3 to 6)."""

    def __init__(self, in_channels: int, hidden_channels: int, kernel: tuple[int, int]):
        super().__init__()
        padding = (kernel[0] // 2, kernel[1] // 2)
        self.convz, self.convr, self.convq = (
            nn.Conv2d(hidden_channels + in_channels, hidden_channels, kernel, padding=padding) for _ in range(3)
        )

    def forward(self, hidden: Tensor, x: Tensor) -> Tensor:
        both = torch.cat([hidden, x], dim=1)
        update, reset = self.convz(both).sigmoid(), self.convr(both).sigmoid()
        candidate = self.convq(torch.cat([reset * hidden, x], dim=1)).tanh()
        return (1 - update) * hidden + update * candidate


class FlowHead(nn.Module):
    """Head that computes the update of the flow, in cells, from the recurrent state."""

    def __init__(self, in_channels: int, head_channels: int):
        super().__init__()
        self.conv1 = nn.Conv2d(in_channels, head_channels, 3, padding=1)
        self.conv2 = nn.Conv2d(head_channels, 2, 3, padding=1)

    def forward(self, hidden: Tensor) -> Tensor:
        return self.conv2(self.conv1(hidden).relu())
