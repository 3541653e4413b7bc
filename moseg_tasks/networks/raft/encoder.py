"""RAFT's encoder of images to an eighth of their size: for the features that are matched, and for the context."""

from typing import Literal

from torch import Tensor, nn

from moseg.tasks.networks.raft.convolution import Norm, conv_norm_relu


class Encoder(nn.Module):
    """A stem and three stages of residual blocks, the resolution halved three times.

    Parameters
    ----------
    block : {"residual", "bottleneck"}
        Two 3x3 convolutions a block, or 1x1, 3x3, 1x1 at a quarter of the channels.
    stage_channels : tuple of int
        Channels at 1/2, 1/4 and 1/8 of the size.
    out_channels : int
        Channels of the output.
    norm : callable or None
        Constructor of the normalisation of a number of channels.
    in_channels : int
        Channels of the images.
    num_blocks : tuple of int
        Blocks at 1/2, 1/4 and 1/8 of the size.
    """

    def __init__(
        self,
        block: Literal["residual", "bottleneck"],
        stage_channels: tuple[int, int, int],
        out_channels: int,
        norm: Norm | None,
        in_channels: int = 3,
        num_blocks: tuple[int, int, int] = (2, 2, 2),
    ):
        super().__init__()
        make = {"residual": ResidualBlock, "bottleneck": BottleneckBlock}[block]

        def make_stage(channels: int, out: int, stride: int, count: int) -> nn.Sequential:
            return nn.Sequential(
                make(channels, out, stride, norm), *(make(out, out, 1, norm) for _ in range(count - 1))
            )

        half, quarter, eighth = stage_channels
        self.convnormrelu = conv_norm_relu(in_channels, half, 7, stride=2, norm=norm)
        self.layer1 = make_stage(half, half, 1, num_blocks[0])
        self.layer2 = make_stage(half, quarter, 2, num_blocks[1])
        self.layer3 = make_stage(quarter, eighth, 2, num_blocks[2])
        self.conv = nn.Conv2d(eighth, out_channels, 1)

    def forward(self, images: Tensor) -> Tensor:
        """Map images (B, channels, y, x) in [-1, 1] to features (B, channels, y / 8, x / 8)."""
        return self.conv(self.layer3(self.layer2(self.layer1(self.convnormrelu(images)))))


class ResidualBlock(nn.Module):
    """Two 3x3 convolutions, each with a ReLU before the sum; in ResNet the second has none."""

    def __init__(self, in_channels: int, out_channels: int, stride: int, norm: Norm | None):
        super().__init__()
        self.convnormrelu1 = conv_norm_relu(in_channels, out_channels, 3, stride, norm)
        self.convnormrelu2 = conv_norm_relu(out_channels, out_channels, 3, norm=norm)
        self.downsample = _shortcut(in_channels, out_channels, stride, norm)

    def forward(self, x: Tensor) -> Tensor:
        return (self.downsample(x) + self.convnormrelu2(self.convnormrelu1(x))).relu()


class BottleneckBlock(nn.Module):
    """A 3x3 convolution at a quarter of the channels, between two of 1x1."""

    def __init__(self, in_channels: int, out_channels: int, stride: int, norm: Norm | None):
        super().__init__()
        inner = out_channels // 4
        self.convnormrelu1 = conv_norm_relu(in_channels, inner, 1, norm=norm)
        self.convnormrelu2 = conv_norm_relu(inner, inner, 3, stride, norm)
        self.convnormrelu3 = conv_norm_relu(inner, out_channels, 1, norm=norm)
        self.downsample = _shortcut(in_channels, out_channels, stride, norm)

    def forward(self, x: Tensor) -> Tensor:
        return (self.downsample(x) + self.convnormrelu3(self.convnormrelu2(self.convnormrelu1(x)))).relu()


def _shortcut(in_channels: int, out_channels: int, stride: int, norm: Norm | None) -> nn.Module:
    """Return a block's shortcut: a projection where the block changes the resolution, else the identity."""
    if stride == 1:
        return nn.Identity()
    return conv_norm_relu(in_channels, out_channels, 1, stride, norm, has_relu=False)
