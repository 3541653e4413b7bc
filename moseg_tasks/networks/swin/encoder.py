"""The Swin image encoder: patches, stages of blocks, and a mean token."""

import torch
from torch import nn

from moseg.tasks.networks.swin.block import SwinBlock
from moseg.tasks.networks.swin.config import SwinConfig


class PatchEmbedding(nn.Module):
    """Each patch of the image as one token."""

    def __init__(self, patch_size: int, width: int):
        super().__init__()
        self.proj = nn.Conv2d(3, width, patch_size, stride=patch_size)
        self.norm = nn.LayerNorm(width)

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        """Map (B, 3, y, x) to (B, y / patch, x / patch, C)."""
        return self.norm(self.proj(images).permute(0, 2, 3, 1))


class PatchMerging(nn.Module):
    """Four neighbouring tokens into one of twice the channels."""

    def __init__(self, width: int):
        super().__init__()
        self.norm = nn.LayerNorm(4 * width)
        self.reduction = nn.Linear(4 * width, 2 * width, bias=False)

    def forward(self, grid: torch.Tensor) -> torch.Tensor:
        """Map (B, y, x, C) to (B, y / 2, x / 2, 2 C)."""
        # The weights were trained with the four in column order, not in row order.
        corners = [grid[:, y::2, x::2] for x in (0, 1) for y in (0, 1)]
        return self.reduction(self.norm(torch.cat(corners, dim=-1)))


class Stage(nn.Module):
    """Blocks of one resolution, every second one shifted, and the merging to the next resolution if there is one."""

    def __init__(self, config: SwinConfig, stage: int):
        super().__init__()
        side, width, heads = config.side(stage), config.width(stage), config.num_heads[stage]
        window = config.window(stage)
        self.blocks = nn.ModuleList(
            SwinBlock(side, width, heads, window, bool(index % 2), config.mlp_ratio)
            for index in range(config.depths[stage])
        )
        self.downsample = PatchMerging(width) if stage + 1 < len(config.depths) else nn.Identity()

    def forward(self, grid: torch.Tensor) -> torch.Tensor:
        for block in self.blocks:
            grid = block(grid)
        return self.downsample(grid)


class SwinEncoder(nn.Module):
    """Image tokens of a Swin Transformer, with their mean in front.

    Parameters
    ----------
    config : SwinConfig

    References
    ----------
    Liu et al., "Swin Transformer: Hierarchical Vision Transformer using Shifted Windows", ICCV 2021.
    """

    def __init__(self, config: SwinConfig):
        super().__init__()
        self.config = config
        self.patch_embed = PatchEmbedding(config.patch_size, config.embed_dim)
        self.layers = nn.ModuleList(Stage(config, stage) for stage in range(len(config.depths)))
        self.norm = nn.LayerNorm(config.output_width)

    def forward(self, images: torch.Tensor) -> torch.Tensor:
        """Encode images as tokens.

        Parameters
        ----------
        images : (B, 3, image_size, image_size)
            Normalised RGB.

        Returns
        -------
        tokens : (B, 1 + n, C)
            The mean of the n tokens of the last stage, then those tokens in raster order.
        """
        grid = self.patch_embed(images)
        for stage in self.layers:
            grid = stage(grid)
        tokens = self.norm(grid).flatten(1, 2)
        return torch.cat([tokens.mean(1, keepdim=True), tokens], dim=1)
