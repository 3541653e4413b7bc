"""The decoder: propagated features to logits at a quarter of the frame's resolution."""

import torch
from torch import nn
from torch.nn import functional as F

from moseg.tasks.networks.deaot.config import DeaotConfig
from moseg.tasks.networks.deaot.encoder import EXPANSION, Pyramid

NORM_GROUPS = 8


class ConvNorm(nn.Module):
    """Convolution, group normalisation, ReLU."""

    def __init__(self, width_in: int, width_out: int, kernel_size: int):
        super().__init__()
        self.conv = nn.Conv2d(width_in, width_out, kernel_size, padding=kernel_size // 2)
        self.gn = nn.GroupNorm(NORM_GROUPS, width_out)

    def forward(self, x: torch.Tensor) -> torch.Tensor:
        return F.relu(self.gn(self.conv(x)))


class FpnDecoder(nn.Module):
    """Feature pyramid from stride 16 to stride 4, with shortcuts from the encoder.

    References
    ----------
    Lin et al., "Feature Pyramid Networks for Object Detection", CVPR 2017.
    """

    def __init__(self, config: DeaotConfig):
        super().__init__()
        wide, narrow = config.d_model, config.d_model // 2
        stride4, stride8, stride16 = (EXPANSION * width for width in config.stage_widths)
        self.conv_in = ConvNorm(2 * wide, wide, 1)
        self.conv_16x = ConvNorm(wide, wide, 3)
        self.conv_8x = ConvNorm(wide, narrow, 3)
        self.conv_4x = ConvNorm(narrow, narrow, 3)
        self.adapter_16x = nn.Conv2d(stride16, wide, 1)
        self.adapter_8x = nn.Conv2d(stride8, wide, 1)
        self.adapter_4x = nn.Conv2d(stride4, narrow, 1)
        self.conv_out = nn.Conv2d(narrow, 1 + config.max_objects, 1)

    def forward(self, propagated: torch.Tensor, pyramid: Pyramid) -> torch.Tensor:
        """Return logits (batch, 1 + max_objects, y, x), background first, from features (batch, 2 d_model, y, x)."""
        x = self.conv_in(propagated)
        x = self.conv_16x(self.adapter_16x(pyramid.stride16) + x)
        x = self.conv_8x(self.adapter_8x(pyramid.stride8) + _enlarged(x, pyramid.stride8))
        x = self.conv_4x(self.adapter_4x(pyramid.stride4) + _enlarged(x, pyramid.stride4))
        return self.conv_out(x)


def _enlarged(x: torch.Tensor, like: torch.Tensor) -> torch.Tensor:
    """Resize `x` to the resolution of `like` with aligned corners."""
    return F.interpolate(x, size=like.shape[-2:], mode="bilinear", align_corners=True)
