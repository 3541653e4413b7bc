"""The convolutional encoder: a fine and a coarse feature map of one frame."""

import torch
import torch.nn.functional as F
from torch import nn

from moseg.tasks.networks.bootstapir.config import BootsTapirConfig

STRIDES = (1, 2, 2, 1)
"""Of the four stages, after a first convolution of stride 2."""


class ResidualBlock(nn.Module):
    """Two convolutions, each after a normalisation, beside the identity or a projection of the normalised input."""

    def __init__(self, inputs: int, outputs: int, stride: int, is_projected: bool):
        super().__init__()
        self.stride = stride
        self.proj_conv = nn.Conv2d(inputs, outputs, 1, stride=stride, bias=False) if is_projected else None
        self.bn_0 = nn.InstanceNorm2d(inputs, affine=True)
        self.conv_0 = nn.Conv2d(inputs, outputs, 3, stride=stride, bias=False)
        self.bn_1 = nn.InstanceNorm2d(outputs, affine=True)
        self.conv_1 = nn.Conv2d(outputs, outputs, 3, padding=1, bias=False)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        y = self.bn_0(x).relu()
        shortcut = x if self.proj_conv is None else self.proj_conv(y)
        # The network was trained by JAX, which pads strided convolutions at the lower right only.
        y = self.conv_0(F.pad(y, (1, 1, 1, 1) if self.stride == 1 else (0, 2, 0, 2)))
        return self.conv_1(self.bn_1(y).relu()) + shortcut


class ResNet(nn.Module):
    """Residual network without a final normalisation; its names are those of the published state dict."""

    def __init__(self, config: BootsTapirConfig):
        super().__init__()
        self.initial_conv = nn.Conv2d(3, config.widths[0], 7, stride=2, bias=False)
        inputs = (config.widths[0], *config.widths[:-1])
        self.block_groups = nn.ModuleList(map(_Stage, inputs, config.widths, STRIDES))

    def forward(self, images: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Map images (B, 3, y, x) in -1..1 to maps at a quarter (B, `fine`, …) and at an eighth (B, `coarse`, …)."""
        x = self.initial_conv(F.pad(images, (2, 4, 2, 4)))
        maps = []
        for stage in self.block_groups:
            x = stage(x)
            maps.append(x)
        return maps[1], maps[3]


class _Stage(nn.Module):
    """Two residual blocks, the first of which has the stage's stride."""

    def __init__(self, inputs: int, outputs: int, stride: int):
        super().__init__()
        first, second = ResidualBlock(inputs, outputs, stride, True), ResidualBlock(outputs, outputs, 1, False)
        self.blocks = nn.ModuleList([first, second])

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        for block in self.blocks:
            x = block(x)
        return x


class ExtraConvolutions(nn.Module):
    """Blocks of convolutions by which BootsTAPIR differs from TAPIR: maps (B, C, y, x) to the same shape."""

    def __init__(self, config: BootsTapirConfig):
        super().__init__()
        blocks = (_ExtraBlock(config.coarse, config.extra_expansion) for _ in range(config.extra_blocks))
        self.blocks = nn.ModuleList(blocks)

    def forward(self, maps: torch.Tensor) -> torch.Tensor:
        for block in self.blocks:
            maps = block(maps)
        return maps


class _ExtraBlock(nn.Module):
    """Two convolutions beside the normalised input."""

    def __init__(self, channels: int, expansion: int):
        super().__init__()
        self.layer_norm = nn.LayerNorm(channels)
        self.conv = nn.Conv2d(channels, expansion * channels, 3, padding=1)
        self.conv_1 = nn.Conv2d(expansion * channels, channels, 3, padding=1)

    def forward(self, maps: torch.Tensor) -> torch.Tensor:
        maps = self.layer_norm(maps.permute(0, 2, 3, 1)).permute(0, 3, 1, 2)
        return maps + self.conv_1(F.gelu(self.conv(maps), approximate="tanh"))
