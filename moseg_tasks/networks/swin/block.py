"""The block of a Swin Transformer: attention within windows, then a perceptron."""

import torch
from torch import nn
from torch.nn import functional


class WindowAttention(nn.Module):
    """Multi-head self-attention within windows, biased by the relative position of two tokens (paper's eq. 4)."""

    def __init__(self, width: int, num_heads: int, window: int):
        super().__init__()
        self.num_heads = num_heads
        self.relative_position_bias_table = nn.Parameter(torch.zeros((2 * window - 1) ** 2, num_heads))
        self.qkv = nn.Linear(width, 3 * width)
        self.proj = nn.Linear(width, width)
        self.register_buffer("positions", relative_positions(window), persistent=False)

    def forward(self, windows: torch.Tensor, sight: torch.Tensor | None) -> torch.Tensor:
        """Map (B * windows, n, C) to the same; `sight` is bool (windows, 1, n, n), None if every token sees all."""
        count, tokens, width = windows.shape
        query, key, value = self.qkv(windows).view(count, tokens, 3, self.num_heads, -1).permute(2, 0, 3, 1, 4)
        bias = self.relative_position_bias_table[self.positions].permute(2, 0, 1)[None]
        if sight is not None:
            bias = bias.masked_fill(~sight, float("-inf")).repeat(count // len(sight), 1, 1, 1)
        seen = functional.scaled_dot_product_attention(query, key, value, attn_mask=bias.to(query.dtype))
        return self.proj(seen.transpose(1, 2).reshape(count, tokens, width))


class Perceptron(nn.Module):
    """Two linear layers with a GELU between them."""

    def __init__(self, width: int, hidden: int):
        super().__init__()
        self.fc1 = nn.Linear(width, hidden)
        self.fc2 = nn.Linear(hidden, width)

    def forward(self, tokens: torch.Tensor) -> torch.Tensor:
        return self.fc2(functional.gelu(self.fc1(tokens)))


class SwinBlock(nn.Module):
    """Window attention and a perceptron, each after a norm and added to its input (paper's eq. 3).

    Parameters
    ----------
    side, width, num_heads, window : int
        Grid side (tokens), channels, heads and window side (tokens) of the stage.
    is_shifted : bool
        The windows are shifted by half a window, as in every second block. One that fills the grid is never shifted.
    mlp_ratio : int
        Hidden channels of the perceptron over `width`.
    """

    def __init__(self, side: int, width: int, num_heads: int, window: int, is_shifted: bool, mlp_ratio: int):
        super().__init__()
        self.window = window
        self.shift = window // 2 if is_shifted and window < side else 0
        self.norm1 = nn.LayerNorm(width)
        self.attn = WindowAttention(width, num_heads, window)
        self.norm2 = nn.LayerNorm(width)
        self.mlp = Perceptron(width, mlp_ratio * width)
        sight = shifted_sight(side, window, self.shift) if self.shift else None
        self.register_buffer("sight", sight, persistent=False)

    def forward(self, grid: torch.Tensor) -> torch.Tensor:
        """Map (B, y, x, C) to the same."""
        rolled = torch.roll(self.norm1(grid), (-self.shift, -self.shift), dims=(1, 2))
        attended = join_windows(self.attn(cut_windows(rolled, self.window), self.sight), grid.shape[1])
        grid = grid + torch.roll(attended, (self.shift, self.shift), dims=(1, 2))
        return grid + self.mlp(self.norm2(grid))


def cut_windows(grid: torch.Tensor, window: int) -> torch.Tensor:
    """Divide (B, y, x, C) into (B * windows, window * window, C); the windows of an image in raster order."""
    batch, height, width, channels = grid.shape
    blocks = grid.view(batch, height // window, window, width // window, window, channels)
    return blocks.transpose(2, 3).reshape(-1, window * window, channels)


def join_windows(windows: torch.Tensor, side: int) -> torch.Tensor:
    """Join the windows of `cut_windows` into the square (B, side, side, C)."""
    tokens, channels = windows.shape[1:]
    window = round(tokens**0.5)
    blocks = windows.view(-1, side // window, side // window, window, window, channels)
    return blocks.transpose(2, 3).reshape(-1, side, side, channels)


def relative_positions(window: int) -> torch.Tensor:
    """Return the bias table's row, int64 (n, n), of each pair of the n = window^2 tokens: one for each offset."""
    position = torch.cartesian_prod(torch.arange(window), torch.arange(window)).view(-1, 2)
    offset = position[:, None] - position[None] + window - 1
    return offset[..., 0] * (2 * window - 1) + offset[..., 1]


def shifted_sight(side: int, window: int, shift: int) -> torch.Tensor:
    """Return which tokens of a window attend to each other in a grid rolled by `shift`, bool (windows, 1, n, n).

    The roll brings opposite borders of the image into one window; tokens attend only to former neighbours.
    """
    place = torch.arange(side)
    # 0 inside, 1 and 2 on the two sides of the seam in the last row or column of windows.
    region = (place >= side - window).long() + (place >= side - shift).long()
    labels = (3 * region[:, None] + region).view(1, side, side, 1)
    inside = cut_windows(labels, window).squeeze(-1)
    return (inside[:, :, None] == inside[:, None])[:, None]
