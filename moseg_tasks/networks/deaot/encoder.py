"""The image encoder: a ResNet without its last stage."""

from typing import NamedTuple

import torch
from torch import nn
from torch.nn import functional as F

from moseg.tasks.networks.deaot.config import DeaotConfig

EXPANSION = 4
"""Output channels of a bottleneck, as a multiple of its inner channels."""


class Pyramid(NamedTuple):
    """Features of a frame at strides 4, 8 and 16: (batch, channel, y, x) each."""

    stride4: torch.Tensor
    stride8: torch.Tensor
    stride16: torch.Tensor


class FrozenBatchNorm(nn.Module):
    """Batch normalisation by stored statistics; all four vectors are buffers, and no batches are counted."""

    def __init__(self, width: int):
        super().__init__()
        self.register_buffer("weight", torch.ones(width))
        self.register_buffer("bias", torch.zeros(width))
        self.register_buffer("running_mean", torch.zeros(width))
        self.register_buffer("running_var", torch.ones(width))

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return F.batch_norm(x, self.running_mean, self.running_var, self.weight, self.bias, training=False)


class Bottleneck(nn.Module):
    """Three convolutions beside a shortcut; the middle one has the stride."""

    def __init__(self, width_in: int, width: int, stride: int):
        super().__init__()
        width_out = EXPANSION * width
        self.conv1 = nn.Conv2d(width_in, width, 1, bias=False)
        self.bn1 = FrozenBatchNorm(width)
        self.conv2 = nn.Conv2d(width, width, 3, stride, padding=1, bias=False)
        self.bn2 = FrozenBatchNorm(width)
        self.conv3 = nn.Conv2d(width, width_out, 1, bias=False)
        self.bn3 = FrozenBatchNorm(width_out)
        self.downsample = None
        if stride != 1 or width_in != width_out:
            self.downsample = nn.Sequential(
                nn.Conv2d(width_in, width_out, 1, stride, bias=False), FrozenBatchNorm(width_out)
            )

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        shortcut = x if self.downsample is None else self.downsample(x)
        x = F.relu(self.bn1(self.conv1(x)))
        x = F.relu(self.bn2(self.conv2(x)))
        return F.relu(self.bn3(self.conv3(x)) + shortcut)


class ResNetEncoder(nn.Module):
    """Pyramid of a normalised RGB frame.

    References
    ----------
    He, Zhang, Ren, Sun, "Deep Residual Learning for Image Recognition", CVPR 2016. The fourth stage is left out, as in
    Oh et al., "Video Object Segmentation using Space-Time Memory Networks", ICCV 2019.
    """

    def __init__(self, config: DeaotConfig):
        super().__init__()
        self.conv1 = nn.Conv2d(3, config.stem_width, 7, stride=2, padding=3, bias=False)
        self.bn1 = FrozenBatchNorm(config.stem_width)
        width0, width1, width2 = config.stage_widths
        depth0, depth1, depth2 = config.stage_depths
        self.layer1 = _stage(config.stem_width, width0, depth0, stride=1)
        self.layer2 = _stage(EXPANSION * width0, width1, depth1, stride=2)
        self.layer3 = _stage(EXPANSION * width1, width2, depth2, stride=2)

    def forward(self, image: torch.Tensor) -> Pyramid:
        x = F.relu(self.bn1(self.conv1(image)))
        stride4 = self.layer1(F.max_pool2d(x, 3, stride=2, padding=1))
        stride8 = self.layer2(stride4)
        return Pyramid(stride4, stride8, self.layer3(stride8))


def _stage(width_in: int, width: int, depth: int, stride: int) -> nn.Sequential:
    """Return the bottlenecks of one resolution; the first one reduces the resolution."""
    first = Bottleneck(width_in, width, stride)
    return nn.Sequential(first, *(Bottleneck(EXPANSION * width, width, 1) for _ in range(depth - 1)))
