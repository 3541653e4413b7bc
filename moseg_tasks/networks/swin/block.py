"""The block of a Swin Transformer: attention within windows, then a perceptron."""

import torch
from torch import nn
from torch.nn import functional

from moseg.tasks.networks.swin.windows import cut_windows, join_windows, relative_positions, shifted_sight


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
        """(B * windows, n, C) to the same; `sight` is bool (windows, 1, n, n), None where all tokens see each other."""
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
        The windows lie half a window off the grid, as in every second block. A window that fills the grid never does.
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
        """(B, y, x, C) to the same."""
        rolled = torch.roll(self.norm1(grid), (-self.shift, -self.shift), dims=(1, 2))
        attended = join_windows(self.attn(cut_windows(rolled, self.window), self.sight), grid.shape[1])
        grid = grid + torch.roll(attended, (self.shift, self.shift), dims=(1, 2))
        return grid + self.mlp(self.norm2(grid))
