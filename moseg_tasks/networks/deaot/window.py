"""The neighbourhood that short-term propagation looks into."""

from typing import NamedTuple

import torch


class Window(NamedTuple):
    """Which place of the other frame lies where in the window around a place of this one.

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
    """The square windows of `radius` cells around each cell of a grid of `size` (y, x), row by row."""
    height, width = size
    cells = torch.arange(height * width, device=device)
    y, x = cells // width, cells % width
    dy, dx = y[None, :] - y[:, None], x[None, :] - x[:, None]
    outside_mask = (dy.abs() > radius) | (dx.abs() > radius)
    places = (dy + radius) * (2 * radius + 1) + (dx + radius)
    return Window(places.masked_fill(outside_mask, 0), outside_mask)
