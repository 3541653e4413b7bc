"""DINOv2 as Depth Anything 3 changes it, with the tensor names of the published checkpoints."""

from typing import NamedTuple

import torch
from torch import Tensor, nn
from torch.nn import functional

from moseg.tasks.networks.depth.positions import PATCH, resample_positions
from moseg.tasks.networks.depth_anything_3.config import DepthAnything3Config

BLOCK_EPSILON = 1e-6
MLP_RATIO = 4
ROTATION_BASE = 100.0
"""Base of the wavelengths by which queries and keys are rotated."""

Rotation = tuple[Tensor, Tensor]
"""Cosine and sine (tokens, 2, channels / 4) of the angles of each token, by y and by x."""
MIN_CHOSEN_VIEWS = 3
"""Number of views from which the reference view is a choice; of fewer it is the first."""


class Features(NamedTuple):
    """Tokens of B views.

    Attributes
    ----------
    cells : list of Tensor (B, cells, 2 channels)
        Of the patches, of each output layer: the first half are the tokens of the last block of one view, the second
        those of the layer, normalised.
    cameras : Tensor (B, 2 channels)
        Of the cameras, of the last output layer: the same, not normalised.
    """

    cells: list[Tensor]
    cameras: Tensor


class Backbone(nn.Module):
    """Transformer of patches whose later blocks alternate between the patches of a view and those of all views.

    With a single view both see the same tokens. They differ in the rotation: a block of one view rotates queries and
    keys by the patch's row and column, a block of all views by the same angle for all patches.
    """

    def __init__(self, config: DepthAnything3Config):
        super().__init__()
        self.config = config
        width = config.width
        self.cls_token = nn.Parameter(torch.zeros(1, 1, width))
        # Of the reference view, and of the others.
        self.camera_token = nn.Parameter(torch.zeros(1, 2, width))
        self.pos_embed = nn.Parameter(torch.zeros(1, 1 + config.grid_side**2, width))
        self.patch_embed = nn.ModuleDict({"proj": nn.Conv2d(3, width, PATCH, stride=PATCH)})
        self.blocks = nn.ModuleList(
            _Block(width, config.num_heads, is_normalised=index >= config.multi_view_from)
            for index in range(config.num_layers)
        )
        self.norm = nn.LayerNorm(width)

    def forward(self, pixels: Tensor, num_views: int = 1) -> Features:
        """Return the tokens of normalised RGB (B, 3, y, x), each `num_views` of which in a row are views of one scene.

        The middle view of a scene is its reference, as the authors recommend for frames of a video.
        """
        patches = self.patch_embed["proj"](pixels)
        rows, columns = patches.shape[2:]
        tokens = torch.cat([self.cls_token.expand(len(pixels), -1, -1), patches.flatten(2).transpose(1, 2)], dim=1)
        tokens = tokens + resample_positions(self.pos_embed, rows, columns)
        own, shared = self._rotations(rows, columns, pixels.device)
        shared = tuple(part.repeat(num_views, 1, 1) for part in shared)
        outputs = []
        for index, block in enumerate(self.blocks):
            sees_others = index >= self.config.multi_view_from and index % 2 == 1
            if index == self.config.multi_view_from:
                tokens = torch.cat([self._camera_tokens(len(pixels), num_views).to(tokens.dtype), tokens[:, 1:]], dim=1)
            if sees_others:
                scenes = tokens.unflatten(0, (-1, num_views)).flatten(1, 2)
                tokens = block(scenes, shared).view_as(tokens)
            else:
                tokens = of_view = block(tokens, own)
            if index in self.config.output_layers:
                outputs.append((of_view, tokens))
        cells = [torch.cat([of_view, self.norm(tokens)], dim=2)[:, 1:] for of_view, tokens in outputs]
        return Features(cells, torch.cat(outputs[-1], dim=2)[:, 0])

    def _camera_tokens(self, num_images: int, num_views: int) -> Tensor:
        """Return the first token (B, 1, channels) of each view: one for reference views, another for all others."""
        reference = num_views // 2 if num_views >= MIN_CHOSEN_VIEWS else 0
        kind = (torch.arange(num_images, device=self.camera_token.device) % num_views != reference).long()
        return self.camera_token[0, kind, None]

    def _rotations(self, rows: int, columns: int, device: torch.device) -> tuple[Rotation, Rotation]:
        """Return the rotations of blocks of one view and of all views; the first token, the camera's, is at 0."""
        grid = torch.cartesian_prod(torch.arange(rows, device=device), torch.arange(columns, device=device)) + 1
        own = torch.cat([grid.new_zeros(1, 2), grid])
        shared = own.clamp(max=1)
        num_angles = self.config.width // self.config.num_heads // 4
        speeds = ROTATION_BASE ** (-torch.arange(num_angles, device=device) / num_angles)
        return tuple((angles.cos(), angles.sin()) for angles in (place[..., None] * speeds for place in (own, shared)))


class _Block(nn.Module):
    def __init__(self, width: int, num_heads: int, is_normalised: bool):
        super().__init__()
        self.norm1 = nn.LayerNorm(width, eps=BLOCK_EPSILON)
        self.attn = _Attention(width, num_heads, is_normalised)
        self.ls1 = _Scale(width)
        self.norm2 = nn.LayerNorm(width, eps=BLOCK_EPSILON)
        self.mlp = _Mlp(width)
        self.ls2 = _Scale(width)

    def forward(self, tokens: Tensor, rotation: Rotation) -> Tensor:
        tokens = tokens + self.ls1(self.attn(self.norm1(tokens), rotation))
        return tokens + self.ls2(self.mlp(self.norm2(tokens)))


class _Attention(nn.Module):
    """Self-attention, whose queries and keys are normalised and rotated in the blocks that may see other views."""

    def __init__(self, width: int, num_heads: int, is_normalised: bool):
        super().__init__()
        self.num_heads = num_heads
        self.qkv = nn.Linear(width, 3 * width)
        if is_normalised:
            self.q_norm = nn.LayerNorm(width // num_heads)
            self.k_norm = nn.LayerNorm(width // num_heads)
        self.is_normalised = is_normalised
        self.proj = nn.Linear(width, width)

    def forward(self, tokens: Tensor, rotation: Rotation) -> Tensor:
        queries, keys, values = self.qkv(tokens).unflatten(2, (3, self.num_heads, -1)).permute(2, 0, 3, 1, 4)
        if self.is_normalised:
            queries = _rotate(self.q_norm(queries), rotation).to(values.dtype)
            keys = _rotate(self.k_norm(keys), rotation).to(values.dtype)
        mixed = functional.scaled_dot_product_attention(queries, keys, values)
        return self.proj(mixed.transpose(1, 2).flatten(2))


def _rotate(tokens: Tensor, rotation: Rotation) -> Tensor:
    """Rotate tokens (B, heads, tokens, channels): the first half of the channels by y, the second by x."""
    cosine, sine = rotation
    real, imaginary = tokens.unflatten(3, (2, 2, -1)).unbind(4)
    rotated = (real * cosine - imaginary * sine, imaginary * cosine + real * sine)
    return torch.stack(rotated, dim=4).flatten(3)


class _Scale(nn.Module):
    def __init__(self, width: int):
        super().__init__()
        self.gamma = nn.Parameter(torch.ones(width))

    def forward(self, tokens: Tensor) -> Tensor:
        return tokens * self.gamma


class _Mlp(nn.Module):
    def __init__(self, width: int):
        super().__init__()
        self.fc1 = nn.Linear(width, MLP_RATIO * width)
        self.fc2 = nn.Linear(MLP_RATIO * width, width)

    def forward(self, tokens: Tensor) -> Tensor:
        return self.fc2(functional.gelu(self.fc1(tokens)))
