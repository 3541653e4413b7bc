"""Depth Anything 3's dual dense-prediction head, with the tensor names of published checkpoints."""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from moseg.tasks.networks.depth.positions import PATCH
from moseg.tasks.networks.depth_anything_3.config import DepthAnything3Config

LAST_CHANNELS = 32
POSITION_BASE, POSITION_GAIN = 100.0, 0.1
"""Base of the wavelengths of the positions that are added to maps, and their weight."""


RAY_CHANNELS = 7
LAST_RAY_LEVEL = "3"
"""The published branch of rays has a projection for each of four sizes; only that of the largest is used."""


class Dense(NamedTuple):
    """Output of the head for B images.

    Attributes
    ----------
    depth : Tensor (B, 2, y, x)
        Logarithms of depth and of its confidence minus 1.
    rays : Tensor (B, 7, y', x') or None
        Direction and origin of the rays of a grid of 8 points per patch and axis, and the logarithm of their confidence
        minus 1; None without the branch of rays.
    """

    depth: Tensor
    rays: Tensor | None


class DepthHead(nn.Module):
    """Depth, with or without rays, from the tokens of four layers."""

    def __init__(self, config: DepthAnything3Config, has_rays: bool = False):
        super().__init__()
        width, channels = 2 * config.width, config.stage_channels
        self.norm = nn.LayerNorm(width)
        self.projects = nn.ModuleList(nn.Conv2d(width, number, 1) for number in channels)
        self.resize_layers = nn.ModuleList(
            [
                nn.ConvTranspose2d(channels[0], channels[0], 4, stride=4),
                nn.ConvTranspose2d(channels[1], channels[1], 2, stride=2),
                nn.Identity(),
                nn.Conv2d(channels[3], channels[3], 3, stride=2, padding=1),
            ]
        )
        self.scratch = _Fusion(channels, config.fusion_channels, has_rays)
        self.has_rays = has_rays

    def forward(self, layers: list[Tensor], rows: int, columns: int) -> Dense:
        """Return depth and rays of tokens (B, cells, channels) of patches in `rows` and `columns`."""
        aspect = columns / rows
        maps = []
        for tokens, project, resize in zip(layers, self.projects, self.resize_layers, strict=True):
            cells = self.norm(tokens).transpose(1, 2).unflatten(2, (rows, columns))
            maps.append(resize(add_positions(project(cells), aspect)))
        maps = self.scratch.narrow(maps)
        fused = _resize(self.scratch.fuse(maps), (rows * PATCH, columns * PATCH))
        depth = self.scratch.output_conv2(add_positions(fused, aspect))
        if not self.has_rays:
            return Dense(depth, None)
        return Dense(depth, self.scratch.project_rays(add_positions(self.scratch.fuse_rays(maps), aspect)))


class _Fusion(nn.Module):
    """Maps of four sizes summed from the smallest to the largest, once for depth and once for rays."""

    def __init__(self, stage_channels: tuple[int, ...], channels: int, has_rays: bool):
        super().__init__()
        for index, number in enumerate(stage_channels, 1):
            self.add_module(f"layer{index}_rn", nn.Conv2d(number, channels, 3, padding=1, bias=False))
        for index in (1, 2, 3, 4):
            self.add_module(f"refinenet{index}", _Refinement(channels, is_first=index == 4))
        self.output_conv1 = nn.Conv2d(channels, channels // 2, 3, padding=1)
        self.output_conv2 = nn.Sequential(
            nn.Conv2d(channels // 2, LAST_CHANNELS, 3, padding=1), nn.ReLU(), nn.Conv2d(LAST_CHANNELS, 2, 1)
        )

        if has_rays:
            self._add_rays(channels)

    def _add_rays(self, channels: int) -> None:
        """Add the modules of the branch of rays."""
        for index in (1, 2, 3, 4):
            self.add_module(f"refinenet{index}_aux", _Refinement(channels, is_first=index == 4))
        half = channels // 2
        sizes = ((channels, half), (half, channels), (channels, half), (half, channels), (channels, half))
        neck = nn.Sequential(*(nn.Conv2d(*size, 3, padding=1) for size in sizes))
        last = nn.Sequential(
            nn.Conv2d(half, LAST_CHANNELS, 3, padding=1),
            nn.Identity(),
            _ChannelNorm(LAST_CHANNELS),
            nn.Identity(),
            nn.ReLU(),
            nn.Conv2d(LAST_CHANNELS, RAY_CHANNELS, 1),
        )
        self.output_conv1_aux = nn.ModuleDict({LAST_RAY_LEVEL: neck})
        self.output_conv2_aux = nn.ModuleDict({LAST_RAY_LEVEL: last})

    def narrow(self, maps: list[Tensor]) -> list[Tensor]:
        """Return maps of one number of channels, which both branches read."""
        return [self.get_submodule(f"layer{index}_rn")(each) for index, each in enumerate(maps, 1)]

    def fuse(self, maps: list[Tensor]) -> Tensor:
        """Return the sum for depth, at twice the size of the largest map, with half of the channels."""
        return self.output_conv1(self._sum(maps, "refinenet{}"))

    def fuse_rays(self, maps: list[Tensor]) -> Tensor:
        """Return the sum for rays, of the same size."""
        return self.output_conv1_aux[LAST_RAY_LEVEL](self._sum(maps, "refinenet{}_aux"))

    def project_rays(self, fused: Tensor) -> Tensor:
        """Return rays (B, 7, y, x) of the sum."""
        return self.output_conv2_aux[LAST_RAY_LEVEL](fused)

    def _sum(self, maps: list[Tensor], name: str) -> Tensor:
        sizes = [tuple(2 * side for side in maps[0].shape[2:]), *(tuple(each.shape[2:]) for each in maps)]
        fused = None
        for index in (4, 3, 2, 1):
            fused = self.get_submodule(name.format(index))(fused, maps[index - 1], sizes[index - 1])
        return fused


class _ChannelNorm(nn.LayerNorm):
    """Normalisation of the channels of each pixel of (B, channels, y, x)."""

    def forward(self, maps: Tensor) -> Tensor:
        return super().forward(maps.movedim(1, 3)).movedim(3, 1)


class _Refinement(nn.Module):
    """Sum with a larger map, and its enlargement."""

    def __init__(self, channels: int, is_first: bool):
        super().__init__()
        if not is_first:
            self.resConfUnit1 = _Residual(channels)
        self.resConfUnit2 = _Residual(channels)
        self.out_conv = nn.Conv2d(channels, channels, 1)

    def forward(self, fused: Tensor | None, added: Tensor, size: tuple[int, int]) -> Tensor:
        total = added if fused is None else fused + self.resConfUnit1(added)
        return self.out_conv(_resize(self.resConfUnit2(total), size))


class _Residual(nn.Module):
    def __init__(self, channels: int):
        super().__init__()
        self.conv1 = nn.Conv2d(channels, channels, 3, padding=1)
        self.conv2 = nn.Conv2d(channels, channels, 3, padding=1)

    def forward(self, maps: Tensor) -> Tensor:
        return maps + self.conv2(self.conv1(maps.relu()).relu())


def add_positions(maps: Tensor, aspect: float) -> Tensor:
    """Add sines and cosines of x to the first half of the channels of (B, channels, y, x), of y to the second.

    Positions lie in [-1, 1], the diagonal of an image of the width-to-height ratio `aspect` having length 2.
    """
    channels, height, width = maps.shape[1:]
    diagonal = (aspect**2 + 1) ** 0.5
    waves = [
        _waves(extent / diagonal, side, channels // 4, maps.device) for extent, side in ((aspect, width), (1.0, height))
    ]
    by_x = waves[0][:, None, :].expand(-1, height, -1)
    by_y = waves[1][:, :, None].expand(-1, -1, width)
    return maps + POSITION_GAIN * torch.cat([by_x, by_y]).to(maps.dtype)


def _waves(extent: float, side: int, num_waves: int, device: torch.device) -> Tensor:
    """Return sines and cosines (2 num_waves, side) of the centres of `side` pixels that fill [-extent, extent]."""
    last = extent * (side - 1) / side
    places = torch.linspace(-last, last, side, device=device)
    speeds = POSITION_BASE ** (-torch.arange(num_waves, device=device) / num_waves)
    angles = speeds[:, None] * places
    return torch.cat([angles.sin(), angles.cos()])


def _resize(maps: Tensor, size: tuple[int, int]) -> Tensor:
    return functional.interpolate(maps, size=size, mode="bilinear", align_corners=True)
