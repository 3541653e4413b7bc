"""Cutting a grid of tokens into windows, and which tokens of a window see each other."""

import torch


def cut_windows(grid: torch.Tensor, window: int) -> torch.Tensor:
    """(B, y, x, C) as (B * windows, window * window, C); the windows of an image in raster order."""
    batch, height, width, channels = grid.shape
    blocks = grid.view(batch, height // window, window, width // window, window, channels)
    return blocks.transpose(2, 3).reshape(-1, window * window, channels)


def join_windows(windows: torch.Tensor, side: int) -> torch.Tensor:
    """The square (B, side, side, C) that `cut_windows` has cut."""
    tokens, channels = windows.shape[1:]
    window = round(tokens**0.5)
    blocks = windows.view(-1, side // window, side // window, window, window, channels)
    return blocks.transpose(2, 3).reshape(-1, side, side, channels)


def relative_positions(window: int) -> torch.Tensor:
    """int64 (n, n) row of the bias table for each pair of the n = window^2 tokens: a row for each offset in y and x."""
    position = torch.cartesian_prod(torch.arange(window), torch.arange(window)).view(-1, 2)
    offset = position[:, None] - position[None] + window - 1
    return offset[..., 0] * (2 * window - 1) + offset[..., 1]


def shifted_sight(side: int, window: int, shift: int) -> torch.Tensor:
    """bool (windows, 1, n, n): which tokens of a window see each other in a grid rolled by `shift`.

    The roll brings opposite borders of the image into one window; tokens see only those they touched before it.
    """
    place = torch.arange(side)
    # 0 inside, 1 and 2 on the two sides of the seam in the last row or column of windows.
    region = (place >= side - window).long() + (place >= side - shift).long()
    labels = (3 * region[:, None] + region).view(1, side, side, 1)
    inside = cut_windows(labels, window).squeeze(-1)
    return (inside[:, :, None] == inside[:, None])[:, None]
