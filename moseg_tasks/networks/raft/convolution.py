"""A convolution with its normalisation and ReLU: the unit of the published state dicts."""

from collections.abc import Callable

from torch import nn

Norm = Callable[[int], nn.Module]


def conv_norm_relu(
    in_channels: int,
    out_channels: int,
    kernel: int,
    stride: int = 1,
    norm: Norm | None = None,
    has_relu: bool = True,
) -> nn.Sequential:
    """Return a convolution that keeps the size (at stride 1), an optional normalisation, and ReLU."""
    layers: list[nn.Module] = [nn.Conv2d(in_channels, out_channels, kernel, stride, padding=kernel // 2)]
    if norm is not None:
        layers.append(norm(out_channels))
    if has_relu:
        layers.append(nn.ReLU(inplace=True))
    return nn.Sequential(*layers)
