"""Gated propagation: attention, globally or in a window, whose result is gated, smoothed and projected."""

from typing import NamedTuple

import torch
from torch import nn
from torch.nn import functional as F


class Window(NamedTuple):
    """Positions of the other frame's cells in the windows around this frame's cells.

    Attributes
    ----------
    places : int64 (query, key)
        Row of the relative embedding for the key's offset from the query; 0 outside the window.
    outside_mask : bool (query, key)
        The key lies outside the query's window.
    """

    places: torch.Tensor
    outside_mask: torch.Tensor


def neighbourhood(size: tuple[int, int], radius: int, device: torch.device) -> Window:
    """Return the square windows of `radius` cells around each cell of a grid of `size` (y, x), row by row."""
    height, width = size
    cells = torch.arange(height * width, device=device)
    y, x = cells // width, cells % width
    dy, dx = y[None, :] - y[:, None], x[None, :] - x[:, None]
    outside_mask = (dy.abs() > radius) | (dx.abs() > radius)
    places = (dy + radius) * (2 * radius + 1) + (dx + radius)
    return Window(places.masked_fill(outside_mask, 0), outside_mask)


MAX_SCORES = 1 << 24
"""Attention scores held at a time (64 MB): more queries are processed in parts, to bound memory."""


def at_least_float32(x: torch.Tensor) -> torch.Tensor:
    """Convert half precision to float32: a softmax over thousands of places needs the precision."""
    return x.to(torch.promote_types(x.dtype, torch.float32))


def attend(query: torch.Tensor, keys: torch.Tensor, values: torch.Tensor) -> torch.Tensor:
    """Average values by the softmax of scaled dot products.

    Parameters
    ----------
    query : (batch, query, d_att)
    keys : (batch, key, d_att)
    values : (batch, key, channel)

    Returns
    -------
    (batch, query, channel)
    """
    rows = max(1, MAX_SCORES // (keys.shape[0] * keys.shape[1]))
    parts = []
    for part in (query / keys.shape[-1] ** 0.5).split(rows, dim=1):
        scores = at_least_float32(part @ keys.transpose(1, 2))
        parts.append(scores.softmax(dim=-1) @ values)
    return torch.cat(parts, dim=1)


class DepthwiseConv(nn.Module):
    """A 5x5 convolution of each channel on the frame's grid."""

    def __init__(self, width: int):
        super().__init__()
        self.conv = nn.Conv2d(width, width, 5, padding=2, groups=width, bias=False)

    def forward(self, tokens: torch.Tensor, size: tuple[int, int]) -> torch.Tensor:
        grid = tokens.transpose(1, 2).unflatten(2, size)
        return self.conv(grid).flatten(2).transpose(1, 2)


class GatedPropagation(nn.Module):
    """Long-term propagation: attention to all frames in memory.

    References
    ----------
    Yang and Yang, "Decoupling Features in Hierarchical Propagation for Video Object Segmentation", NeurIPS 2022,
    section 4.2.
    """

    def __init__(self, d_model: int):
        super().__init__()
        self.dw_conv = DepthwiseConv(4 * d_model)
        self.projection = nn.Linear(4 * d_model, 2 * d_model)

    def forward(
        self,
        query: torch.Tensor,
        keys: torch.Tensor,
        values: torch.Tensor,
        gate: torch.Tensor,
        size: tuple[int, int],
    ) -> torch.Tensor:
        """Return both branches' update, (batch, cell, 2 d_model), from values and gate of 4 d_model channels."""
        return self.put_out(attend(query, keys, values), gate, size)

    def put_out(self, attended: torch.Tensor, gate: torch.Tensor, size: tuple[int, int]) -> torch.Tensor:
        """Gate, smooth and project attended values."""
        return self.projection(self.dw_conv(attended * gate, size))


class LocalGatedPropagation(GatedPropagation):
    """Short-term propagation: attention to a window in the previous frame, with a learned bias for the offset."""

    def __init__(self, d_model: int, radius: int):
        super().__init__(d_model)
        self.relative_emb_k = nn.Conv2d(d_model // 2, (2 * radius + 1) ** 2, 1)

    def forward(
        self,
        query: torch.Tensor,
        keys: torch.Tensor,
        values: torch.Tensor,
        gate: torch.Tensor,
        size: tuple[int, int],
        window: Window,
    ) -> torch.Tensor:
        """Return both branches' update as for long-term propagation; `keys` and `values` are those of one frame."""
        # Copies of each window's values would take (2 radius + 1)^2 times their memory: the whole grid is cheaper.
        relative = F.linear(query, self.relative_emb_k.weight.flatten(1), self.relative_emb_k.bias)
        relative = relative.gather(2, window.places.expand(len(query), -1, -1))
        scores = at_least_float32((query / keys.shape[-1] ** 0.5) @ keys.transpose(1, 2)) + relative
        scores = scores.masked_fill(window.outside_mask, -torch.inf)
        return self.put_out(scores.softmax(dim=-1) @ values, gate, size)


class SelfGatedPropagation(GatedPropagation):
    """Propagation inside one frame, jointly for both branches."""

    def __init__(self, d_model: int):
        super().__init__(d_model)
        self.linear_QK = nn.Linear(2 * d_model, d_model // 2)
        self.linear_V1 = nn.Linear(d_model, 2 * d_model)
        self.linear_V2 = nn.Linear(d_model, 2 * d_model)
        self.linear_U1 = nn.Linear(d_model, 2 * d_model)
        self.linear_U2 = nn.Linear(d_model, 2 * d_model)

    def forward(self, visual: torch.Tensor, identity: torch.Tensor, size: tuple[int, int]) -> torch.Tensor:
        """Return both branches' update, (batch, cell, 2 d_model), from normalised branches of d_model channels each."""
        query = self.linear_QK(torch.cat([visual, identity], dim=-1))
        values = F.silu(torch.cat([self.linear_V1(visual), self.linear_V2(identity)], dim=-1))
        gate = F.silu(torch.cat([self.linear_U1(visual), self.linear_U2(identity)], dim=-1))
        return self.put_out(attend(query, query, values), gate, size)
