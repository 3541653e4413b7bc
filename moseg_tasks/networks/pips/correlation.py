"""Correlation of points' appearances with the feature maps around the points' estimated positions."""

from collections.abc import Sequence

import torch
import torch.nn.functional as F


def feature_pyramid(maps: torch.Tensor, levels: int) -> tuple[torch.Tensor, ...]:
    """Reduce maps (B, C, y, x) to `levels` resolutions, each half the previous one: (B, y, x, C), channels last."""
    pyramid = [maps]
    for _ in range(levels - 1):
        pyramid.append(F.avg_pool2d(pyramid[-1], 2))
    return tuple(level.permute(0, 2, 3, 1).contiguous() for level in pyramid)


def sample_appearances(maps: torch.Tensor, points: torch.Tensor) -> torch.Tensor:
    """Sample one frame's maps (y, x, C) bilinearly at points (N, 2), cells, clamped to the map: (N, C)."""
    height, width = maps.shape[:2]
    last = points.new_tensor([width - 1, height - 1])
    points = points.clamp(torch.zeros_like(last), last)
    corner = points.floor()
    x0, y0 = corner.long().unbind(-1)
    x1, y1 = (x0 + 1).clamp(max=width - 1), (y0 + 1).clamp(max=height - 1)
    x, y = (points - corner)[..., None].unbind(-2)
    above = (1 - x) * maps[y0, x0] + x * maps[y0, x1]
    below = (1 - x) * maps[y1, x0] + x * maps[y1, x1]
    return (1 - y) * above + y * below


def correlate(
    pyramid: Sequence[torch.Tensor], appearances: torch.Tensor, points: torch.Tensor, radius: int
) -> torch.Tensor:
    """Correlate each point's appearance with the square of cells around it, at each level of the pyramid.

    Interpolation is linear, so the maps' cells are correlated first and the correlations interpolated: all samples of
    a square share their fraction of a cell, so only the (2 radius + 2)^2 cells under it are needed. A volume of
    correlations with the whole map, of which these are samples, would take a hundred times as many.

    Parameters
    ----------
    pyramid : sequence of torch.Tensor (S, y, x, C)
        Of `feature_pyramid`, finest first; cells outside a map correlate to 0.
    appearances : torch.Tensor (N, S, C)
    points : torch.Tensor (N, S, 2)
        xy, cells of the finest level.
    radius : int
        Half side of the square, cells of each level.

    Returns
    -------
    correlations : torch.Tensor (N, S, levels * (2 radius + 1)^2)
        Over the root of C; level by level, the square's columns one after the other.
    """
    sampled = []
    # Half precision keeps three digits of a sum over all channels: too few to locate the peak of a correlation.
    with torch.autocast(points.device.type, enabled=False):
        for level, maps in enumerate(pyramid):
            square = correlate_square(maps, appearances, points / 2**level, radius)
            sampled.append(square.flatten(2))
        return torch.cat(sampled, dim=2) / appearances.shape[-1] ** 0.5


def correlate_square(maps: torch.Tensor, appearances: torch.Tensor, points: torch.Tensor, radius: int) -> torch.Tensor:
    """Return interpolated correlations (N, S, 2 radius + 1, 2 radius + 1) around points in cells, indexed [x, y]."""
    num_frames, height, width, channels = maps.shape
    corner = points.floor()
    offsets = torch.arange(-radius, radius + 2, device=points.device)
    x = (corner[..., 0].long()[..., None] + offsets)[..., :, None]
    y = (corner[..., 1].long()[..., None] + offsets)[..., None, :]
    inside = (x >= 0) & (x < width) & (y >= 0) & (y < height)
    frame = torch.arange(num_frames, device=points.device)[:, None, None]
    cells = (frame * height + y.clamp(0, height - 1)) * width + x.clamp(0, width - 1)
    around = maps.reshape(-1, channels)[cells.flatten(2)]
    correlations = (around @ appearances[..., None]).view(inside.shape) * inside
    x, y = (points - corner)[..., None, None].unbind(-3)
    columns = (1 - x) * correlations[..., :-1, :] + x * correlations[..., 1:, :]
    return (1 - y) * columns[..., :-1] + y * columns[..., 1:]
