"""The MLP-Mixer that updates a point's positions and appearances in its whole window."""

from collections import OrderedDict

import torch
from torch import nn

from moseg.tasks.networks.pips.config import PipsConfig

EXPANSION = 4
"""Hidden channels of a mixing layer, as a multiple of its input channels."""
HIGHEST_FREQUENCY = 1000.0
"""Frequencies of the motion's encoding are spaced evenly from 0 to just below this, rad/cell."""


class Update(nn.Module):
    """Corrections of a point's positions and appearances in all frames of a window.

    References
    ----------
    I. Tolstikhin et al., MLP-Mixer: An all-MLP architecture for vision, NeurIPS 2021.
    """

    def __init__(self, config: PipsConfig):
        super().__init__()
        self.config = config
        inputs = config.latent + config.num_correlations + 3 * config.encoding + 3
        self.to_delta = _Mixer(config, inputs, config.window * (2 + config.latent))

    def forward(
        self, appearances: torch.Tensor, correlations: torch.Tensor, displacements: torch.Tensor
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """Map (N, S, C), (N, S, correlations) and (N, S, 2) cells since the first frame to (N, S, 2) and (N, S, C)."""
        motion = encode_motion(displacements, self.config.encoding)
        delta = self.to_delta(torch.cat([appearances, correlations, motion], dim=2))
        delta = delta.to(displacements.dtype).view(*displacements.shape[:2], -1)
        return delta[..., :2], delta[..., 2:]


def encode_motion(displacements: torch.Tensor, channels: int) -> torch.Tensor:
    """Return sines and cosines of displacements (N, S, 2) and time, then both unchanged: (N, S, 3 channels + 3)."""
    num_points, num_frames, _ = displacements.shape
    # As published, the last frame's time is S, not S - 1: the weights were trained with it.
    times = torch.linspace(0, num_frames, num_frames, dtype=displacements.dtype, device=displacements.device)
    motion = torch.cat([displacements, times[None, :, None].expand(num_points, -1, -1)], dim=2)
    steps = torch.arange(0, channels, 2, dtype=displacements.dtype, device=displacements.device)
    phases = motion[..., None] * (steps * (HIGHEST_FREQUENCY / channels))
    waves = torch.stack([phases.sin(), phases.cos()], dim=-1)
    return torch.cat([waves.flatten(2), motion], dim=2)


class _Mixer(nn.Sequential):
    """The mixer, with the published names: 14 is the mean over frames, which has no tensors."""

    def __init__(self, config: PipsConfig, inputs: int, outputs: int):
        layers = [nn.Linear(inputs, config.hidden)]
        layers += [
            nn.Sequential(_frame_mixing(config.window, config.hidden), _channel_mixing(config.hidden))
            for _ in range(config.depth)
        ]
        layers += [nn.LayerNorm(config.hidden), _FrameMean(), nn.Linear(config.hidden, outputs)]
        super().__init__(*layers)


class _FrameMean(nn.Module):
    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return x.mean(dim=1)


class _Residual(nn.Module):
    """x + fn(norm(x))."""

    def __init__(self, channels: int, fn: nn.Module):
        super().__init__()
        self.fn = fn
        self.norm = nn.LayerNorm(channels)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return x + self.fn(self.norm(x))


def _frame_mixing(num_frames: int, channels: int) -> _Residual:
    """Mix frames, separately for each channel: a convolution of width 1 with frames as its channels."""
    inside = EXPANSION * num_frames
    return _Residual(channels, _two_layers(nn.Conv1d(num_frames, inside, 1), nn.Conv1d(inside, num_frames, 1)))


def _channel_mixing(channels: int) -> _Residual:
    """Mix channels, separately for each frame."""
    inside = EXPANSION * channels
    return _Residual(channels, _two_layers(nn.Linear(channels, inside), nn.Linear(inside, channels)))


def _two_layers(first: nn.Module, second: nn.Module) -> nn.Sequential:
    # 2 is a dropout in the published names, of no effect outside training.
    return nn.Sequential(OrderedDict({"0": first, "1": nn.GELU(), "3": second}))
