"""The convolutional encoder: feature maps of one frame."""

import torch
import torch.nn.functional as F
from torch import nn

from moseg.tasks.networks.pips.config import PipsConfig


class ResidualBlock(nn.Module):
    """Two normalised convolutions beside the identity, or beside a strided projection."""

    def __init__(self, inputs: int, outputs: int, stride: int):
        super().__init__()
        self.conv1 = nn.Conv2d(inputs, outputs, 3, stride=stride, padding=1)
        self.conv2 = nn.Conv2d(outputs, outputs, 3, padding=1)
        self.downsample = nn.Sequential(nn.Conv2d(inputs, outputs, 1, stride=stride)) if stride > 1 else None

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        y = F.instance_norm(self.conv1(x)).relu()
        y = F.instance_norm(self.conv2(y)).relu()
        if self.downsample is not None:
            x = F.instance_norm(self.downsample(x))
        return (x + y).relu()


class Encoder(nn.Module):
    """Feature maps at 1 / `stride` of an image's size, computed from four stages between half and a sixteenth of it."""

    def __init__(self, config: PipsConfig):
        super().__init__()
        width1, width2, width3, width4 = config.widths
        self.stride = config.stride
        self.conv1 = nn.Conv2d(3, width1, 7, stride=2, padding=3)
        self.layer1 = _stage(width1, width1, stride=1)
        self.layer2 = _stage(width1, width2, stride=2)
        self.layer3 = _stage(width2, width3, stride=2)
        self.layer4 = _stage(width3, width4, stride=2)
        self.conv2 = nn.Conv2d(sum(config.widths), 2 * config.latent, 3, padding=1)
        self.conv3 = nn.Conv2d(2 * config.latent, config.latent, 1)

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        """Map images (B, 3, y, x) in -1..1 to maps (B, `latent`, y // stride, x // stride)."""
        height, width = images.shape[-2:]
        size = (height // self.stride, width // self.stride)
        x = F.instance_norm(self.conv1(images)).relu()
        maps = []
        for stage in (self.layer1, self.layer2, self.layer3, self.layer4):
            x = stage(x)
            maps.append(F.interpolate(x, size, mode="bilinear", align_corners=True))
        return self.conv3(F.instance_norm(self.conv2(torch.cat(maps, dim=1))).relu())


def _stage(inputs: int, outputs: int, stride: int) -> nn.Sequential:
    return nn.Sequential(ResidualBlock(inputs, outputs, stride), ResidualBlock(outputs, outputs, 1))
