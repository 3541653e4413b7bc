"""The motion network: a U-Net of residual blocks with a branch that sees the whole frame."""

import torch
from torch import Tensor, nn
from torch.nn import functional

from moseg.tasks.motion_network.encoding import CHANNELS

WIDTHS = (16, 32, 64, 96, 128)
"""Channels of each level; each level but the first has half the resolution of the one above it."""
DEEP = (3, 4)
"""Levels with two blocks on the way down."""


class Block(nn.Module):
    """Two 3x3 convolutions beside a short cut."""

    def __init__(self, inputs: int, outputs: int):
        super().__init__()
        self.first = nn.Conv2d(inputs, outputs, 3, padding=1, bias=False)
        self.first_norm = nn.BatchNorm2d(outputs)
        self.second = nn.Conv2d(outputs, outputs, 3, padding=1, bias=False)
        self.second_norm = nn.BatchNorm2d(outputs)
        self.short = nn.Conv2d(inputs, outputs, 1) if inputs != outputs else nn.Identity()

    def forward(self, x: Tensor) -> Tensor:
        """Return float32 (batch, outputs, y, x) for (batch, inputs, y, x)."""
        inner = torch.relu(self.first_norm(self.first(x)))
        return torch.relu(self.second_norm(self.second(inner)) + self.short(x))


class MotionUNet(nn.Module):
    """Logit of each pixel to move on its own, from the channels of `encode_motion`."""

    def __init__(self) -> None:
        super().__init__()
        inputs = (len(CHANNELS), *WIDTHS[:-1])
        self.down = nn.ModuleList(
            nn.Sequential(Block(n, m), *([Block(m, m)] if level in DEEP else []))
            for level, (n, m) in enumerate(zip(inputs, WIDTHS, strict=True))
        )
        self.whole = nn.Conv2d(WIDTHS[-1], WIDTHS[-1], 1)
        upwards = list(zip(WIDTHS[:0:-1], WIDTHS[-2::-1], strict=True))
        self.merge = nn.ModuleList(nn.Conv2d(n + m, m, 1) for n, m in upwards)
        self.up = nn.ModuleList(Block(m, m) for _, m in upwards)
        self.head = nn.Conv2d(WIDTHS[0], 1, 1)

    def forward(self, channels: Tensor) -> Tensor:
        """Return the logits float32 (batch, 1, y, x) of channels float32 (batch, channel, y, x)."""
        x, seen = channels, []
        for level, block in enumerate(self.down):
            x = block(functional.max_pool2d(x, 2) if level else x)
            seen.append(x)
        # The ReLU keeps OpenCV from merging this sum, whose sides differ in size, into the convolution before it.
        x = x + torch.relu(self.whole(x.mean((2, 3), keepdim=True)))
        for merge, block, beside in zip(self.merge, self.up, seen[-2::-1], strict=True):
            x = block(torch.relu(merge(torch.cat([functional.interpolate(x, scale_factor=2.0), beside], 1))))
        return self.head(x)
